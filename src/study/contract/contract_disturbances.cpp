// Checks the reaction of an optimizer to failing evaluations, exceptions and stops.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>

#include "base/temporary_folder.hpp"
#include "study/contract/contract_checks.hpp"
#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

class StoppingObserver : public RunObserver {
 public:
  StoppingObserver(StopSignal& stop, std::uint64_t after) : stop_(stop), after_(after) {}
  void on_progress(const Progress& progress) override {
    if (progress.done - progress.replayed >= after_) {
      stop_.request(StopReason::interrupted);
    }
  }
  void on_message(const std::string& /*message*/) override {}

 private:
  StopSignal& stop_;
  std::uint64_t after_;
};

}  // namespace

ContractFinding check_failures(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    const MemoryEvaluator some = trial.run({.budget = 1000, .fail_every = 3});
    if (!some.best()) {
      return "with every third evaluation failing it found nothing";
    }
    const MemoryEvaluator all = trial.run({.budget = 200, .fail_every = 1});
    return all.trace().empty() ? "it gave up at once" : "";
  });
}

ContractFinding check_stop(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    for (const std::int64_t stop_after : {1, 35, 50}) {
      MemoryEvaluator evaluator =
          trial.make_evaluator({.budget = INT64_MAX, .stop_after = stop_after});
      const auto optimizer = row.make(options);
      optimizer->minimize(evaluator, 1);
      const auto now = std::chrono::steady_clock::now();
      const auto stopped = evaluator.stopped_at();
      if (evaluator.calls_after_stop() > 1) {
        return fmt::format("stopped after {} evaluations, it asked {} times more", stop_after,
                           evaluator.calls_after_stop());
      }
      if (stopped && now - *stopped > std::chrono::seconds(1)) {
        return fmt::format("stopped after {} evaluations, it took {:.1f} s to return", stop_after,
                           std::chrono::duration<double>(now - *stopped).count());
      }
    }
    return "";
  });
}

ContractFinding check_exceptions(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    const auto optimizer = row.make(options);
    const MemoryEvaluator whole = trial.run({.budget = 200});
    for (const std::int64_t throw_at : {1, 2, 40}) {
      if (std::ssize(whole.trace()) < throw_at) {
        continue;  // the optimizer ends by itself before that evaluation
      }
      MemoryEvaluator broken = trial.make_evaluator({.budget = 200, .throw_at = throw_at});
      try {
        optimizer->minimize(broken, 1);
        return fmt::format("an exception of evaluation {} is swallowed", throw_at);
      } catch (const BrokenEvaluator&) {
      }
    }
    MemoryEvaluator sound = trial.make_evaluator({.budget = 200});
    optimizer->minimize(sound, 1);
    return describe_difference(sound.trace(), whole.trace());
  });
}

namespace {

ContractFinding check_resume_on(const std::shared_ptr<const Problem>& problem,
                                const OptimizerRow& row, const Options& options) {
  RunPlan plan;
  plan.problem.problem = problem;
  plan.problem.name = plan.problem.problem->description().name;
  plan.problem.sets.validation_cases = 1;
  plan.problem.sets.test_cases = 1;
  plan.problem.resolved_json = "{}";
  plan.optimizer = row;
  plan.options = options;
  const TemporaryFolder folder;
  const auto run = [&](const char* name, std::uint64_t stop_after, std::int64_t budget = 150) {
    StopSignal stop;
    StoppingObserver observer(stop, stop_after);
    plan.budget = budget;
    return execute_run({plan, folder / name, 2, {}}, stop, observer);
  };
  const auto whole = run("whole", UINT64_MAX);
  if (!whole) {
    return make_broken("a run that nobody stopped has not ended");
  }
  std::optional<RunResult> resumed;
  int runs = 0;
  while (!resumed && runs < 20) {
    resumed = run("pieces", 40);
    ++runs;
  }
  if (!resumed) {
    return make_broken("stopped after every 40 evaluations, a run of 150 has not ended");
  }
  if (!whole->failure.empty() || !resumed->failure.empty()) {
    const bool is_same = whole->failure == resumed->failure || resumed->failure.empty();
    const bool is_one = whole->failure.empty() || is_same;
    return make_broken(is_one ? (whole->failure.empty() ? resumed->failure : whole->failure)
                              : whole->failure + "; resumed: " + resumed->failure);
  }
  if (to_json(*whole) != to_json(*resumed)) {
    return make_broken("a run that was stopped and resumed ends with another result");
  }
  if (row.capabilities.paced) {
    return {};
  }
  const auto begun = run("continued", UINT64_MAX, 75);
  const auto continued = run("continued", UINT64_MAX);
  if (!begun || !continued) {
    return make_broken("a run that nobody stopped has not ended");
  }
  if (to_json(*whole) != to_json(*continued)) {
    return make_broken(
        "a run that was continued with twice the budget ends with another result; declare 'paced' "
        "if it plans with the budget");
  }
  return {};
}

}  // namespace

ContractFinding check_resume(const OptimizerRow& row, const Options& options) {
  const auto problems = make_contract_problems(row);
  for (const auto& problem : {problems.front(), problems.back()}) {  // the last has every type
    const ContractFinding finding = check_resume_on(problem, row, options);
    if (finding.outcome == ContractOutcome::broken) {
      return make_broken(fmt::format("on {}: {}", problem->description().name, finding.detail));
    }
  }
  return {};
}

}  // namespace armwright
