#include "base/read_limit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <ctime>
#include <deque>
#include <string>
#include <vector>

#include "base/expect_error.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

// The limit belongs to the process, so every test sets its own.
class ReadLimits : public testing::Test {
 protected:
  ~ReadLimits() override {
    set_read_limit({.time_s = 1e9, .memory_bytes = std::uint64_t{1} << 60}, stop_,
                   [](const std::string&) {});
  }
  void set(const ReadLimit& limit) {
    set_read_limit(limit, stop_, [this](const std::string& line) { lines_.push_back(line); });
  }
  static StopSignal& make_stop() {
    static std::deque<StopSignal> signals;  // set_read_limit() needs them until the process ends
    return signals.emplace_back();
  }
  StopSignal& stop_ = make_stop();
  std::vector<std::string> lines_;
};

// Works for this much processor time of the thread.
void work(double time_s) {
  const auto now_s = [] {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  for (const double end_s = now_s() + time_s; now_s() < end_s;) {
    check_reading();
  }
}

TEST_F(ReadLimits, ASlowStepIsRefusedWithItsNameAndTheFlag) {
  set({.time_s = 0.05});
  EXPECT_EQ(error_of(ErrorKind::bad_data,
                     [] {
                       const ReadStep outer("the problem 'q1'");
                       const ReadStep inner("proposing a speed for robot 'arm'");
                       work(10);
                     }),
            "reading the problem 'q1' (proposing a speed for robot 'arm') took more than 0.05 s of "
            "processor time, the limit for what is read before a run starts; check the file, or "
            "allow more with --read-limit 0.3s,1GiB");
}

TEST_F(ReadLimits, EveryOutermostStepHasItsOwnTime) {
  set({.time_s = 0.2});
  for (int i = 0; i < 3; ++i) {
    const ReadStep step("a design");
    work(0.12);
  }
  work(0.3);  // no step
}

TEST_F(ReadLimits, MemoryIsLimitedTooAndOnlyItsGrowth) {
  const std::vector<char> before(std::size_t{100} << 20, 'a');
  set({.memory_bytes = std::uint64_t{64} << 20});
  const ReadStep step("the test cases a.csv");
  work(0.05);
  EXPECT_EQ(error_of(ErrorKind::bad_data,
                     [] {
                       const std::vector<char> more(std::size_t{128} << 20, 'a');
                       work(10);
                     }),
            "reading the test cases a.csv took more than 64MiB of memory, the limit for what is "
            "read before a run starts; check the file, or allow more with --read-limit 10s,256MiB");
}

TEST_F(ReadLimits, ProgressIsShownAfterASecond) {
  set({.time_s = 10});
  {
    const ReadStep step("the problem 'q1'");
    work(0.9);
    EXPECT_TRUE(lines_.empty());
    work(0.2);
  }
  EXPECT_THAT(lines_, ElementsAre("still reading the problem 'q1', for 1 s now"));
}

TEST_F(ReadLimits, AStopEndsAStepThatItFindsInProgress) {
  set({.time_s = 10});
  {
    const ReadStep step("the problem 'q1'");
    stop_.request(StopReason::terminated);
    EXPECT_THROW(check_reading(), WorkStopped);
  }
  const ReadStep later("the record, to end in order");
  check_reading();
}

}  // namespace
}  // namespace armwright
