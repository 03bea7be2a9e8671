// Attempts at a cell: their tokens, the state that one takes over from another, and which attempt
// publishes its result.
#include "study/matrix/attempt.hpp"

#include <stdlib.h>

#include <atomic>
#include <barrier>
#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "study/matrix/cell_attempt.hpp"
#include "study/matrix/matrix_support.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class AttemptTest : public MatrixTest {
 protected:
  const Cell cell_ = cell("sphere/ga/r01");
  const std::filesystem::path attempts_ = attempts(cell_);
};

TEST_F(AttemptTest, TokensAreTakenOnceWhoeverIsAtIt) {
  constexpr int kThreads = 4;
  constexpr int kEach = 25;
  std::mutex mutex;
  std::set<int> tokens;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < kEach; ++j) {
        const Attempt attempt(attempts_, study_, 0);
        const std::lock_guard lock(mutex);
        tokens.insert(attempt.token());
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(tokens.size(), kThreads * kEach);
  EXPECT_EQ(*tokens.begin(), 1);
  const auto listed = list_tokens(attempts_);
  EXPECT_EQ(std::set<int>(listed.begin(), listed.end()), tokens);
}

TEST_F(AttemptTest, TheNewestIsValid) {
  const Attempt first(attempts_, study_, 0);
  EXPECT_EQ(first.find_successor(), "");
  std::filesystem::create_directory(attempts_ / "notes");
  const Attempt second(attempts_, study_, 0);
  EXPECT_EQ(first.find_successor(), "superseded by attempt 2");
  EXPECT_EQ(second.find_successor(), "");
  std::filesystem::create_directory(attempts_ / "1000");
  EXPECT_EQ(Attempt(attempts_, study_, 0).token(), 1001);
  std::filesystem::remove_all(attempts_);
  EXPECT_THAT(second.find_successor(), HasSubstr("its folder is gone"));
  const Attempt again(attempts_, study_, 5);
  EXPECT_EQ(again.token(), 1);
  EXPECT_THAT(first.find_successor(), HasSubstr("its folder is gone"));
  EXPECT_EQ(again.find_successor(), "");
}

TEST_F(AttemptTest, AnOrphanBetweenTwoCellsBeginsNone) {
  ::setenv("PBS_JOBID", "7[2].head", 1);
  const Attempt requeued(attempts_, study_, 1000);
  EXPECT_EQ(find_later_life(attempts_, 900), "superseded by attempt 1");
  EXPECT_EQ(find_later_life(attempts_, 1000), "");
  EXPECT_EQ(find_later_life(attempts_, 1100), "");
  ::setenv("PBS_JOBID", "7[3].head", 1);
  EXPECT_EQ(find_later_life(attempts_, 900), "");
  ::unsetenv("PBS_JOBID");
  EXPECT_EQ(find_later_life(attempts_, 900), "");
}

TEST_F(AttemptTest, GoesOnWithWhatTheFurthestHasEvaluated) {
  StopSignal stop;
  StoppingObserver stopping(stop, 20);
  const CellAttempt first =
      attempt_cell(plan_, cell_, {.study = study_, .command_line = {}}, stop, stopping);
  EXPECT_EQ(first.end, CellAttempt::End::stopped);
  // One attempt without evaluations, and one without a journal.
  std::filesystem::create_directories(attempts_ / "002/run");
  std::ofstream(attempts_ / "002/run/manifest.json") << "{}";
  std::ofstream(attempts_ / "002/run/journal") << "AWJRNL01";
  std::filesystem::create_directories(attempts_ / "003/run");
  StopSignal none;
  SilentObserver observer;
  const CellAttempt last =
      attempt_cell(plan_, cell_, {.study = study_, .command_line = {}}, none, observer);
  EXPECT_EQ(last.end, CellAttempt::End::done);
  EXPECT_THAT(observer.messages, Contains(HasSubstr("resuming: ")));
  EXPECT_THAT(list_tokens(attempts_), ElementsAre(1, 2, 3, 4));
  run_in(cell_, temporary_ / "whole");
  EXPECT_EQ(read_file(temporary_ / "whole/cell.json", 1 << 20),
            read_file(place(cell_) / "cell.json", 1 << 20));
}

TEST_F(AttemptTest, PassesOverAJournalThatIsDamaged) {
  run_in(cell_, attempts_ / "001/run");
  std::filesystem::remove(attempts_ / "001/run/cell.json");
  std::string journal = read_file(attempts_ / "001/run/journal", 1 << 20);
  journal[60] ^= 1;
  std::ofstream(attempts_ / "001/run/journal") << journal;
  StopSignal stop;
  SilentObserver observer;
  EXPECT_EQ(attempt_cell(plan_, cell_, {.study = study_, .command_line = {}}, stop, observer).end,
            CellAttempt::End::done);
  EXPECT_THAT(observer.messages, Contains(HasSubstr("001/run cannot be resumed")));
}

TEST_F(AttemptTest, TakesOverFromALocalComparisonAndTheOtherWayRound) {
  run_in(cell_, temporary_ / "whole");
  const std::string whole = read_file(temporary_ / "whole/cell.json", 1 << 20);
  const Cell other = cell("sphere/random/r02");
  StopSignal stop;
  StoppingObserver stopping(stop, 20);
  run_cell(plan_, cell_, study_, stop, stopping);
  ASSERT_TRUE(std::filesystem::exists(place(cell_) / "journal"));
  StopSignal none;
  SilentObserver observer;
  EXPECT_EQ(attempt_cell(plan_, cell_, {.study = study_, .command_line = {}}, none, observer).end,
            CellAttempt::End::done);
  EXPECT_THAT(observer.messages, Contains(HasSubstr("resuming: ")));
  EXPECT_TRUE(std::filesystem::exists(attempts_ / "001/aside/journal"));
  EXPECT_EQ(read_file(place(cell_) / "cell.json", 1 << 20), whole);

  StopSignal again;
  StoppingObserver soon(again, 20);
  attempt_cell(plan_, other, {.study = study_, .command_line = {}}, again, soon);
  adopt_attempts(plan_, study_, observer_);
  EXPECT_GT(std::filesystem::file_size(place(other) / "journal"), 500U);
  EXPECT_EQ(run_all(plan_, "study", 2), 0U);
  for (const Cell& one : list_cells(plan_)) {
    EXPECT_TRUE(load_cell(plan_, one, study_));
  }
}

TEST_F(AttemptTest, IsStoppedByANewerOneAndPublishesNothing) {
  StopSignal stop;
  // The newer attempt begins during the run, which would not end by itself.
  class Successor final : public RunObserver {
   public:
    Successor(std::filesystem::path attempts, StopSignal& ends)
        : attempts_(std::move(attempts)), ends_(ends) {}
    void on_progress(const Progress& progress) override {
      if (progress.done >= 20 && !newer_) {
        newer_.emplace(attempts_, attempts_, 0);
        while (!ends_.requested()) {
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      }
    }
    void on_message(const std::string& /*message*/) override {}

   private:
    std::filesystem::path attempts_;
    StopSignal& ends_;
    std::optional<Attempt> newer_;
  };
  Successor successor(attempts_, stop);
  const CellAttempt old =
      attempt_cell(plan_, cell_, {.study = study_, .command_line = {}}, stop, successor);
  EXPECT_EQ(old.end, CellAttempt::End::superseded);
  EXPECT_EQ(old.successor, "superseded by attempt 2");
  EXPECT_FALSE(std::filesystem::exists(place(cell_)));
  EXPECT_EQ(attempt(cell_).end, CellAttempt::End::done);
}

TEST_F(AttemptTest, TheFirstOfManyThatFinishAtOnceIsPublished) {
  constexpr int kThreads = 4;
  run_in(cell_, temporary_ / "whole");
  for (const char* before : {"nothing", "unfinished", "finished"}) {
    SCOPED_TRACE(before);
    std::filesystem::remove_all(place(cell_));
    if (before != std::string("nothing")) {
      std::filesystem::create_directories(place(cell_).parent_path());
      std::filesystem::copy(temporary_ / "whole", place(cell_));
    }
    if (before == std::string("unfinished")) {
      std::filesystem::remove(place(cell_) / "cell.json");
    }
    std::vector<std::filesystem::path> folders;
    for (int i = 0; i < kThreads; ++i) {
      folders.push_back(temporary_ / (before + std::to_string(i)));
      std::filesystem::create_directory(folders.back());
      std::filesystem::copy(temporary_ / "whole", folders.back() / "run");
    }
    std::barrier start(kThreads);
    std::atomic<int> published = 0;
    std::vector<std::thread> threads;
    for (const auto& folder : folders) {
      threads.emplace_back([&] {
        start.arrive_and_wait();
        const bool is_ours = publish_cell(plan_, cell_, study_, folder / "run", folder / "aside");
        published += is_ours ? 1 : 0;
      });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    if (before == std::string("unfinished")) {
      // A thread that moves the unfinished cell aside may move a finished one of another thread. An
      // identical one then takes its place.
      EXPECT_GE(published, 1);
    } else {
      EXPECT_EQ(published, before == std::string("nothing") ? 1 : 0);
    }
    EXPECT_TRUE(load_cell(plan_, cell_, study_));
    EXPECT_EQ(read_file(place(cell_) / "cell.json", 1 << 20),
              read_file(temporary_ / "whole/cell.json", 1 << 20));
  }
}

TEST_F(AttemptTest, WhatALocalComparisonWritesIsLeftToIt) {
  run_in(cell_, temporary_ / "whole");
  std::filesystem::create_directories(place(cell_));
  const RunLock lock{Folder(place(cell_))};
  EXPECT_THAT(
      error_of(
          ErrorKind::busy,
          [&] { publish_cell(plan_, cell_, study_, temporary_ / "whole", temporary_ / "aside"); }),
      HasSubstr("is being written by process "));
  EXPECT_TRUE(std::filesystem::exists(temporary_ / "whole/cell.json"));
}

TEST_F(AttemptTest, AnErrorIsRecorded) {
  std::filesystem::create_directories(place(cell_));
  std::ofstream(place(cell_) / "cell.json") << "no cell";
  StopSignal stop;
  error_of(ErrorKind::bad_data, [&] { attempt(cell_, stop); });
  const AttemptState state = read_attempt(attempts_, 1);
  EXPECT_THAT(state.error, HasSubstr("is not a cell that armwright wrote"));
  EXPECT_FALSE(state.silence_s);
}

TEST_F(AttemptTest, RecordsThatAreBrokenAreNobodys) {
  for (const std::string text :
       {"", "{", "[]", "{\"format\": 2}", "{\"format\": 1, \"host\": 3}"}) {
    EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { parse_attempt(text, "attempt.json"); }),
                HasSubstr("attempt.json"));
  }
  EXPECT_THAT(
      error_of(ErrorKind::bad_data, [] { parse_attempt(std::string(100'000, '['), "a.json"); }),
      HasSubstr("a.json"));
  const auto folder = attempts_ / "001";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "attempt.json") << std::string(100'000, '[');
  std::ofstream(folder / "alive") << "{\"cases\": -1}";
  std::ofstream(folder / "error.txt") << "\x1b[31mred\nmore";
  const AttemptState state = read_attempt(attempts_, 1);
  EXPECT_FALSE(state.record);
  EXPECT_FALSE(state.cases);
  EXPECT_EQ(state.error, "?[31mred");
  AttemptRecord record = describe_this_process(5);
  record.host = "a\x1b\xff";
  EXPECT_EQ(parse_attempt(to_json(record), "a.json").process_begun_s, 5);
}

}  // namespace
}  // namespace armwright
