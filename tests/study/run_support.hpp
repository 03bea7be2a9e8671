// Helpers for tests of whole runs: a silent observer, small plans, a fixture with a folder.
#pragma once

#include <gtest/gtest.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/bits.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

class SilentObserver : public RunObserver {
 public:
  void on_progress(const Progress& progress) override {
    const std::lock_guard lock(mutex_);
    last = progress;
  }
  void on_message(const std::string& message) override { messages.push_back(message); }
  Progress last;
  std::vector<std::string> messages;

 private:
  std::mutex mutex_;
};

// Stops a run after a number of cases, as Ctrl-C would.
class StoppingObserver final : public SilentObserver {
 public:
  StoppingObserver(StopSignal& stop, std::uint64_t after) : stop_(stop), after_(after) {}
  void on_progress(const Progress& progress) override {
    if (progress.done - progress.replayed >= after_) {
      stop_.request(StopReason::interrupted);
    }
  }

 private:
  StopSignal& stop_;
  std::uint64_t after_;
};

// Returns a plan for a short run of the thesis's problem: few validation and test cases, small
// populations.
inline RunPlan make_small_plan(const std::string& optimizer = "ga", std::int64_t budget = 40) {
  RunPlan plan;
  plan.problem = load_problem(
      "q1-complex", std::vector<std::string>{"physics.engine=ode", "workspace.points=4",
                                             "sets.validation_cases=3", "sets.test_cases=4"});
  plan.optimizer = load_optimizer(optimizer);
  const std::vector<std::string> options =
      optimizer == "ga" ? std::vector<std::string>{"population=8"} : std::vector<std::string>{};
  plan.options = Options::parse(optimizer, plan.optimizer.options, options);
  plan.budget = budget;
  plan.schedule = plan.problem.schedule;
  if (!plan.optimizer.capabilities.generations) {
    plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 2};
  }
  return plan;
}

// Executes runs in a temporary folder.
class RunTest : public testing::Test {
 protected:
  std::optional<RunResult> run(const RunPlan& plan, const std::string& folder, unsigned jobs = 2) {
    StopSignal stop;
    return execute_run({plan, temporary_ / folder, jobs, {"armwright", "optimize"}}, stop,
                       observer_);
  }
  JournalContent read(const std::string& folder) {
    return read_journal(temporary_ / folder / "journal");
  }
  std::string read_result(const std::string& folder) {
    return read_file(temporary_ / folder / "result.json", 1 << 24);
  }
  TemporaryFolder temporary_;
  SilentObserver observer_;
};

inline void expect_same_evaluations(const JournalContent& a, const JournalContent& b) {
  ASSERT_EQ(a.training.size(), b.training.size());
  for (std::size_t i = 0; i < a.training.size(); ++i) {
    EXPECT_EQ(a.training[i].index, b.training[i].index);
    EXPECT_EQ(a.training[i].generation, b.training[i].generation);
    EXPECT_EQ(a.training[i].cases.numbers, b.training[i].cases.numbers);
    EXPECT_TRUE(same_bits(a.training[i].x, b.training[i].x)) << i;
    EXPECT_TRUE(
        same_bits(a.training[i].evaluation.objectives, b.training[i].evaluation.objectives));
    EXPECT_TRUE(
        same_bits(a.training[i].evaluation.case_errors, b.training[i].evaluation.case_errors));
    EXPECT_TRUE(same_bits(a.training[i].evaluation.metrics, b.training[i].evaluation.metrics));
  }
}

}  // namespace armwright
