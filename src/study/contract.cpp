#include "study/contract.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "base/temporary_folder.hpp"
#include "study/contract_problems.hpp"
#include "study/memory_evaluator.hpp"
#include "study/run.hpp"

namespace armwright {
namespace {

using Settings = MemoryEvaluatorSettings;
using Entry = MemoryEvaluator::Entry;

ContractFinding make_broken(std::string detail) {
  return {ContractOutcome::broken, std::move(detail)};
}

ContractFinding make_exempt(std::string why) {
  return {ContractOutcome::exempt, std::move(why)};
}

// One optimizer on one problem.
struct Trial {
  const OptimizerRow& row;
  const Options& options;
  const ContractProblem& problem;

  MemoryEvaluator run(const Settings& settings, std::uint64_t seed = 1) const {
    MemoryEvaluator evaluator(*problem.problem, settings);
    row.make(options)->minimize(evaluator, seed);
    return evaluator;
  }
};

// The first thing that is wrong on any problem that suits the optimizer.
ContractFinding check_on_all(const OptimizerRow& row, const Options& options,
                             const std::function<std::string(const Trial&)>& find_fault) {
  const std::vector<ContractProblem> problems = make_contract_problems(row);
  if (problems.empty()) {
    return make_broken("none of the problems it could be tried on suits it");
  }
  for (const ContractProblem& problem : problems) {
    const std::string fault = find_fault({row, options, problem});
    if (!fault.empty()) {
      return make_broken(fmt::format("on {}: {}", problem.name, fault));
    }
  }
  return {};
}

std::string describe_difference(const std::vector<Entry>& a, const std::vector<Entry>& b) {
  const std::size_t common = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < common; ++i) {
    if (!(a[i] == b[i])) {
      return fmt::format("evaluation {} differs", i);
    }
  }
  return a.size() == b.size()
             ? ""
             : fmt::format("one run made {} evaluations, the other {}", a.size(), b.size());
}

ContractFinding check_repeatable(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [](const Trial& trial) {
    return describe_difference(trial.run({.budget = 400}, 3).trace(),
                               trial.run({.budget = 400}, 3).trace());
  });
}

// Some draw lots in some places only, so one problem on which the seed matters is enough.
ContractFinding check_seed(const OptimizerRow& row, const Options& options) {
  bool matters = false;
  const ContractFinding finding =
      check_on_all(row, options, [&](const Trial& trial) -> std::string {
        const bool differ =
            trial.run({.budget = 400}, 0).trace() != trial.run({.budget = 400}, 1).trace();
        matters = matters || differ;
        return differ && !row.capabilities.stochastic
                   ? "seeds 0 and 1 give different runs, though it does not declare 'stochastic'"
                   : "";
      });
  if (finding.outcome == ContractOutcome::held && row.capabilities.stochastic && !matters) {
    return make_broken("seeds 0 and 1 give the same run, though it declares 'stochastic'");
  }
  return finding;
}

ContractFinding check_memory_between_runs(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const Trial& trial) {
    const auto optimizer = row.make(options);
    MemoryEvaluator first(*trial.problem.problem, {.budget = 200});
    MemoryEvaluator second(*trial.problem.problem, {.budget = 200});
    optimizer->minimize(first, 3);
    optimizer->minimize(second, 3);
    return describe_difference(first.trace(), second.trace());
  });
}

ContractFinding check_budget(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const Trial& trial) -> std::string {
    for (const std::int64_t budget : {1, 2, 36, 137}) {
      const MemoryEvaluator evaluator = trial.run({.budget = budget});
      if (evaluator.trace().empty()) {
        return fmt::format("a budget of {} led to no evaluation at all", budget);
      }
      if (evaluator.calls_after_stop() > 1) {
        return fmt::format("with a budget of {} it went on asking {} times after the end", budget,
                           evaluator.calls_after_stop());
      }
    }
    return "";
  });
}

ContractFinding check_zero_budget(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [](const Trial& trial) {
    const MemoryEvaluator evaluator = trial.run({.budget = 0});
    return evaluator.calls_after_stop() > 1 ? "it goes on asking without a budget" : "";
  });
}

ContractFinding check_beginning(const OptimizerRow& row, const Options& options) {
  if (row.capabilities.paced) {
    return make_exempt("it divides the budget up beforehand");
  }
  return check_on_all(row, options, [](const Trial& trial) -> std::string {
    const MemoryEvaluator small = trial.run({.budget = 90});
    const MemoryEvaluator large = trial.run({.budget = 300});
    if (small.trace().size() > large.trace().size()) {
      return "a larger budget led to fewer evaluations";
    }
    for (std::size_t i = 0; i < small.trace().size(); ++i) {
      if (small.trace()[i].evaluated != large.trace()[i].evaluated) {
        return fmt::format("evaluation {} depends on the budget; declare 'paced' if it must", i);
      }
    }
    return "";
  });
}

ContractFinding check_points(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const Trial& trial) -> std::string {
    const MemoryEvaluator evaluator = trial.run({.budget = 600});
    for (std::size_t i = 0; i < evaluator.trace().size(); ++i) {
      const Entry& entry = evaluator.trace()[i];
      if (!std::ranges::all_of(entry.asked, [](double v) { return std::isfinite(v); })) {
        return fmt::format("evaluation {} asks for a coordinate that is no finite number", i);
      }
      if (row.capabilities.bounds && entry.score.clipped) {
        return fmt::format("evaluation {} lies outside the bounds, though it declares 'bounds'", i);
      }
    }
    return "";
  });
}

ContractFinding check_batches(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const Trial& trial) -> std::string {
    const MemoryEvaluator evaluator = trial.run({.budget = 200});
    const bool has_batches =
        std::ranges::any_of(evaluator.batch_sizes(), [](std::size_t size) { return size > 1; });
    if (has_batches != row.capabilities.batch) {
      return has_batches ? "it asks for batches, though it does not declare 'batch'"
                         : "it asks for one point at a time, though it declares 'batch'";
    }
    if ((evaluator.generations() > 0) != row.capabilities.generations) {
      return row.capabilities.generations ? "it declares 'generations' and begins none"
                                          : "it begins generations without declaring them";
    }
    return "";
  });
}

ContractFinding check_failures(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const Trial& trial) -> std::string {
    const MemoryEvaluator some = trial.run({.budget = 1000, .fail_every = 3});
    if (!some.best()) {
      return "with every third evaluation failing it found nothing";
    }
    const MemoryEvaluator all = trial.run({.budget = 200, .fail_every = 1});
    return all.trace().empty() ? "it gave up at once" : "";
  });
}

ContractFinding check_stop(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const Trial& trial) -> std::string {
    for (const std::int64_t stop_after : {1, 35, 50}) {
      MemoryEvaluator evaluator(*trial.problem.problem,
                                {.budget = INT64_MAX, .stop_after = stop_after});
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
  return check_on_all(row, options, [&](const Trial& trial) -> std::string {
    const auto optimizer = row.make(options);
    for (const std::int64_t throw_at : {1, 2, 40}) {
      if (std::ssize(trial.run({.budget = 200}).trace()) < throw_at) {
        continue;  // it ends by itself before
      }
      MemoryEvaluator broken(*trial.problem.problem, {.budget = 200, .throw_at = throw_at});
      try {
        optimizer->minimize(broken, 1);
        return fmt::format("an exception of evaluation {} is swallowed", throw_at);
      } catch (const BrokenEvaluator&) {
      }
    }
    MemoryEvaluator sound(*trial.problem.problem, {.budget = 200});
    optimizer->minimize(sound, 1);
    return describe_difference(sound.trace(), trial.run({.budget = 200}).trace());
  });
}

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

ContractFinding check_resume(const OptimizerRow& row, const Options& options) {
  const ContractProblem problem = make_contract_problems(row).at(0);
  RunPlan plan;
  plan.problem.name = problem.name;
  plan.problem.problem = problem.problem;
  plan.problem.sets.validation_cases = 1;
  plan.problem.sets.test_cases = 1;
  plan.problem.resolved_json = "{}";
  plan.optimizer = row;
  plan.options = options;
  plan.budget = 150;
  const TemporaryFolder folder;
  const auto run = [&](const char* name, std::uint64_t stop_after) {
    StopSignal stop;
    StoppingObserver observer(stop, stop_after);
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
    return make_broken(whole->failure + resumed->failure);
  }
  if (to_json(*whole) != to_json(*resumed)) {
    return make_broken("a run that was stopped and resumed ends with another result");
  }
  return {};
}

std::size_t count_descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

ContractFinding check_leaks(const OptimizerRow& row, const Options& options) {
  const ContractProblem problem = make_contract_problems(row).at(0);
  const auto run = [&] {
    for (int i = 0; i < 10; ++i) {
      Trial{row, options, problem}.run({.budget = 100});
    }
  };
  run();  // what is made once and kept is there now
  const std::size_t descriptors = count_descriptors();
  // What is leaked grows with every round; caches that libraries and threads fill come to an end.
  // A run that forgets one vector of the sphere's ten numbers leaves a hundred bytes.
  constexpr int kRounds = 6;
  constexpr std::size_t kTolerance_bytes = 1000;
  std::size_t left_bytes = kTolerance_bytes + 1;
  for (int round = 0; round < kRounds && left_bytes > kTolerance_bytes; ++round) {
    const std::size_t before = mallinfo2().uordblks;
    run();
    const std::size_t after = mallinfo2().uordblks;
    left_bytes = after > before ? after - before : 0;
  }
  const std::size_t descriptors_after = count_descriptors();
  if (descriptors_after > descriptors) {
    return make_broken(
        fmt::format("its runs leave {} file descriptors open", descriptors_after - descriptors));
  }
  if (left_bytes > kTolerance_bytes) {
    return make_broken(fmt::format("10 runs leave {} bytes behind", left_bytes));
  }
  if (waitpid(-1, nullptr, WNOHANG) >= 0) {
    return make_broken("a run leaves a process behind");
  }
  return {};
}

double calc_success(const Trial& trial, std::int64_t budget, std::uint64_t seed) {
  const MemoryEvaluator evaluator = trial.run({.budget = budget}, seed);
  if (trial.problem.problem->description().objectives.size() == 1) {
    return -evaluator.best().value_or(std::numeric_limits<double>::infinity());
  }
  std::vector<std::vector<double>> objectives;
  for (const Entry& entry : evaluator.trace()) {
    objectives.push_back(entry.score.objectives);
  }
  return calc_hypervolume(std::move(objectives));
}

double calc_median_success(const Trial& trial, std::int64_t budget) {
  std::vector<double> success;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    success.push_back(calc_success(trial, budget, seed));
    if (!trial.row.capabilities.stochastic) {
      return success.front();
    }
  }
  std::ranges::sort(success);
  return success[2];
}

ContractFinding check_learning(const OptimizerRow& row, const Options& options) {
  if (row.capabilities.sampling) {
    return make_exempt("it samples, and does not learn");
  }
  constexpr std::int64_t kBudget = 5000;
  const OptimizerRow& random = find_optimizer("random");
  const Options random_options = Options::parse(random.name, random.options, {});
  const bool many = row.requirements.objectives > 1;
  int contests = 0;
  for (const ContractProblem& problem : make_contract_problems(row)) {
    if (!many && problem.name != "sphere" && problem.name != "ellipsoid" &&
        problem.name != "rosenbrock") {
      continue;
    }
    ++contests;
    const double own = calc_median_success({row, options, problem}, kBudget);
    const double chance = calc_median_success({random, random_options, problem}, kBudget);
    if (own <= chance) {
      return make_broken(
          fmt::format("on {}: no better than random search ({} against {}, {} "
                      "evaluations, median of 5 seeds)",
                      problem.name, many ? own : -own, many ? chance : -chance, kBudget));
    }
  }
  return contests > 0 ? ContractFinding{} : make_broken("no function suits it");
}

}  // namespace

const std::vector<ContractCheck>& contract_checks() {
  static const std::vector<ContractCheck> checks = {
      {"Budget", "asks for no more than the budget allows", check_budget},
      {"ZeroBudget", "is content with a budget of nothing", check_zero_budget},
      {"Points", "asks for finite points, inside the bounds if it says so", check_points},
      {"Repeatable", "same seed, same evaluations", check_repeatable},
      {"Seed", "uses its seed if it says so, and only then", check_seed},
      {"Memory", "keeps nothing from one run for the next", check_memory_between_runs},
      {"Beginning", "a smaller budget is the beginning of a larger one", check_beginning},
      {"Batches", "batches and generations are as declared", check_batches},
      {"Failures", "survives evaluations that fail", check_failures},
      {"Exceptions", "lets an exception of the evaluator through", check_exceptions},
      {"Stop", "stops within a second when told to", check_stop},
      {"Resume", "stopped and resumed, gives the same result", check_resume},
      {"Leaks", "leaves no memory, descriptor or process behind", check_leaks},
      {"Learning", "beats random search", check_learning},
  };
  return checks;
}

ContractFinding run_contract_check(const ContractCheck& check, const OptimizerRow& row,
                                   const Options& options) {
  try {
    return check.run(row, options);
  } catch (const std::exception& error) {
    return make_broken(error.what());
  }
}

}  // namespace armwright
