// Checks the state after an optimizer's runs (nothing is left behind) and their results.
#include <fmt/format.h>
#include <malloc.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>

#include "optimizers/table/optimizer_table.hpp"
#include "study/contract/contract_checks.hpp"
#include "study/statistics/pareto.hpp"

namespace armwright {
namespace {

std::size_t count_descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

double calc_success(const ContractTrial& trial, std::int64_t budget, std::uint64_t seed) {
  const MemoryEvaluator evaluator = trial.run({.budget = budget}, seed);
  if (trial.problem.description().objectives.size() == 1) {
    return -evaluator.best().value_or(std::numeric_limits<double>::infinity());
  }
  std::vector<std::vector<double>> objectives;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    objectives.push_back(entry.score.objectives);
  }
  return calc_hypervolume(objectives, std::array{kLargestObjective, kLargestObjective});
}

double calc_median_success(const ContractTrial& trial, std::int64_t budget) {
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

}  // namespace

ContractFinding check_leaks(const OptimizerRow& row, const Options& options) {
  const auto problem = make_contract_problems(row).at(0);
  // An optimizer with a limit of evaluations is slow, and has built its models after 40 of them.
  const std::int64_t budget = row.limits.evaluations > 0 ? 40 : 100;
  const auto run = [&] {
    for (int i = 0; i < 10; ++i) {
      ContractTrial{row, options, *problem}.run({.budget = budget});
    }
  };
  run();  // allocates what is made once and kept
  const std::size_t descriptors = count_descriptors();
  // Leaks grow with every round; the caches of libraries and threads stop growing. A run that leaks
  // one vector of the sphere's ten numbers leaves a hundred bytes.
  constexpr int kRounds = 20;
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

ContractFinding check_learning(const OptimizerRow& row, const Options& options) {
  if (row.capabilities.sampling) {
    return make_exempt("it samples, and does not learn");
  }
  const std::int64_t budget = limit_budget(row, 5000);
  const OptimizerRow& random = find_optimizer("random");
  const Options random_options = Options::parse(random.name, random.options, {});
  const bool many = row.requirements.objectives > 1;
  int contests = 0;
  for (const auto& problem : make_contract_problems(row)) {
    const std::string& name = problem->description().name;
    const bool counts =
        many ? name == "zdt1" : name == "sphere" || name == "ellipsoid" || name == "rosenbrock";
    if (!counts) {
      continue;
    }
    ++contests;
    const double own = calc_median_success({row, options, *problem}, budget);
    const double chance = calc_median_success({random, random_options, *problem}, budget);
    if (own <= chance) {
      return make_broken(
          fmt::format("on {}: no better than random search ({} against {}, {} "
                      "evaluations, median of 5 seeds)",
                      name, many ? own : -own, many ? chance : -chance, budget));
    }
  }
  return contests > 0 ? ContractFinding{} : make_broken("no function suits it");
}

ContractFinding check_constraints(const OptimizerRow& row, const Options& options) {
  const bool weighs = std::ranges::count(row.options, "constraint_weight", &OptionSpec::name) > 0;
  if (!row.capabilities.constraints && !weighs) {
    return make_exempt("it declares neither 'constraints' nor an option constraint_weight");
  }
  const std::int64_t budget = limit_budget(row, 2000);
  // The start is feasible and has 38.75; most optimizers come within 1 % of the optimum, -44.
  constexpr double kWorst = -10;
  for (const auto& problem : make_contract_problems(row)) {
    if (problem->description().constraints.empty()) {
      continue;
    }
    const double best = -calc_median_success({row, options, *problem}, budget);
    if (!(best <= kWorst)) {
      return make_broken(fmt::format(
          "on {}: its best feasible value is {} ({} evaluations, median of 5 seeds), and "
          "{} is easily reached",
          problem->description().name, best, budget, kWorst));
    }
  }
  return {};
}

}  // namespace armwright
