// Tests times.json: a run adds the times of its lives, and nothing depends on them.
#include "study/run/run_times.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <thread>

#include "base/expect_error.hpp"
#include "base/folder_checksums.hpp"
#include "study/executor/case_executor.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RunTimesTest : public RunTest {
 protected:
  void write_times(const std::string& text) {
    std::ofstream(temporary_ / kTimesFile, std::ios::binary) << text;
  }
};

TEST_F(RunTimesTest, EveryLifeOfARunAddsItsTime) {
  double before_s = 0;
  std::uint64_t lives = 0;
  for (bool done = false; !done;) {
    StopSignal stop;
    StoppingObserver observer(stop, 25);
    done = execute_run({make_small_plan(), temporary_ / "a", 2, {}}, stop, observer).has_value();
    const auto times = load_times(temporary_ / "a");
    ASSERT_TRUE(times);
    EXPECT_EQ(times->lives, ++lives);
    EXPECT_GE(times->wall_s, before_s);
    EXPECT_TRUE(times->cpu_s);
    before_s = times->wall_s;
  }
  EXPECT_GT(lives, 1u);
  EXPECT_GT(before_s, 0);
}

TEST_F(RunTimesTest, ShowingACompleteRunAddsNothing) {
  run(make_small_plan(), "a");
  run(make_small_plan(), "a");
  EXPECT_EQ(load_times(temporary_ / "a")->lives, 1u);
}

TEST_F(RunTimesTest, NoChecksumCoversTheTimes) {
  run(make_small_plan(), "a");
  const FolderChecksums checksums(temporary_ / "a");
  EXPECT_TRUE(checksums.covers("result.json"));
  EXPECT_FALSE(checksums.covers(kTimesFile));
}

TEST_F(RunTimesTest, AWaitCostsTimeOnTheClockButNoProcessorTime) {
  const RunClock clock;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  clock.add_to(Folder(temporary_.path()), true);
  const auto times = load_times(temporary_.path());
  ASSERT_TRUE(times && times->cpu_s);
  EXPECT_GE(times->wall_s, 0.05);
  EXPECT_LT(*times->cpu_s, times->wall_s);
}

TEST_F(RunTimesTest, TheProcessorTimeStaysUnknownOnceOthersHaveSimulated) {
  const Folder folder(temporary_.path());
  RunClock().add_to(folder, true);
  RunClock().add_to(folder, false);
  RunClock().add_to(folder, true);
  const auto times = load_times(temporary_.path());
  ASSERT_TRUE(times);
  EXPECT_FALSE(times->cpu_s);
  EXPECT_EQ(times->lives, 3u);
}

TEST_F(RunTimesTest, ADamagedFileIsNamedAndTheNextLifeReplacesIt) {
  EXPECT_FALSE(load_times(temporary_.path()));
  for (const char* text :
       {"", "{}", "[1]", R"({"wall_s": -1, "cpu_s": 0, "lives": 1})",
        R"({"wall_s": 1, "cpu_s": "2", "lives": 1})", R"({"wall_s": 1, "cpu_s": 2, "lives": -1})",
        R"({"wall_s": 1, "cpu_s": -2, "lives": 1})"}) {
    SCOPED_TRACE(text);
    write_times(text);
    EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { load_times(temporary_.path()); }),
                AllOf(HasSubstr("times.json: "), HasSubstr("remove it")));
    EXPECT_FALSE(find_times(temporary_.path()));
    RunClock().add_to(Folder(temporary_.path()), true);
    EXPECT_EQ(load_times(temporary_.path())->lives, 1u);
  }
}

}  // namespace
}  // namespace armwright
