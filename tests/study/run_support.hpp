// What tests of whole runs share: a silent observer, small plans.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "base/temporary_folder.hpp"
#include "study/run.hpp"

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

// A short run of the thesis's problem: few cases to judge on, small populations.
inline RunPlan make_small_plan(const std::string& optimizer = "ga", std::int64_t budget = 40) {
  RunPlan plan;
  plan.problem = load_problem(
      "q1-complex", std::vector<std::string>{"workspace.points=4", "sets.validation_cases=3",
                                             "sets.test_cases=4"});
  plan.optimizer = load_optimizer(optimizer);
  const std::vector<std::string> options =
      optimizer == "ga" ? std::vector<std::string>{"population=8"} : std::vector<std::string>{};
  plan.options = Options::parse(optimizer, plan.optimizer.options, options);
  plan.budget = budget;
  plan.schedule = plan.problem.schedule;
  if (!plan.optimizer.capabilities.generations) {
    plan.schedule = {.fresh = false, .cases = 2};
  }
  return plan;
}

}  // namespace armwright
