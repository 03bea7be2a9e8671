#include "study/analysis/method_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/text.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

// Evaluates the start of a cell on its first training cases and returns the number of residuals.
std::size_t count_residuals_on(const RunPlan& run, std::size_t cases) {
  const Problem& problem = *run.problem.problem;
  const std::vector<double> start = list_starts(problem.description().variables);
  CaseBlock block{.role = CaseRole::training, .set = run.problem.sets.training, .numbers = {}};
  block.numbers.resize(cases);
  std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
  return problem.evaluate(start, block).residuals.size();
}

// Returns the number of residuals of an evaluation on all cases of the schedule. Every case adds the
// same number; some objectives add residuals that belong to no case.
std::size_t count_residuals(const RunPlan& run) {
  const std::size_t one = count_residuals_on(run, 1);
  const auto others = static_cast<std::size_t>(run.schedule.cases) - 1;
  const std::size_t per_case = others == 0 ? 0 : count_residuals_on(run, 2) - one;
  run.problem.problem->forget_cases();
  return one + others * per_case;
}

bool uses_jacobian(const StudyOptimizer& optimizer, const ProblemDescription& problem) {
  const auto& options = optimizer.parsed.values();
  const auto derivatives = options.find("derivatives");
  return problem.has_jacobian && derivatives != options.end() &&
         derivatives->second == OptionValue(std::string("exact"));
}

void add_runs(const StudyPlan& plan, const StudyProblem& problem, const StudyOptimizer& optimizer,
              std::span<const CellOutcome> cells, MethodFacts& facts) {
  constexpr double kUnused = 0.01;
  std::vector<double> judged;
  for (const CellOutcome& cell : cells) {
    if (cell.problem != problem.label || cell.optimizer != optimizer.label ||
        cell.end_reason == kNotEnded) {
      continue;
    }
    ++facts.runs;
    if (cell.judged && !plan.judge_along) {
      judged.push_back(static_cast<double>(*cell.judged));
    }
    const auto budget = static_cast<double>(plan.budget);
    if (cell.end_reason == "budget" ||
        budget - static_cast<double>(cell.cases) < kUnused * budget) {
      continue;
    }
    const bool is_first = facts.early_runs++ == 0;
    facts.early_fewest_cases =
        is_first ? cell.cases : std::min(facts.early_fewest_cases, cell.cases);
    facts.early_most_cases = std::max(facts.early_most_cases, cell.cases);
    facts.early_reasons.insert(cell.end_reason);
  }
  if (!judged.empty()) {
    facts.judged = calc_spread(judged).median;
  }
}

// Returns whether defaults of the optimizer were chosen on this problem, or on another problem with
// the same arm.
bool is_tuned_on(const OptimizerRow& row, const LoadedProblem& loaded) {
  const auto has = [&](const std::string& name) {
    return std::ranges::count(row.tuned_on, name) > 0;
  };
  const TrackingProblem* tracking = loaded.tracking();
  return has(loaded.name) || (tracking != nullptr && has(tracking->config().robot.name));
}

}  // namespace

std::vector<MethodFacts> calc_method_facts(const StudyPlan& plan, std::string_view problem,
                                           std::span<const CellOutcome> cells) {
  const auto found = std::ranges::find(plan.problems, problem, &StudyProblem::label);
  const auto p = static_cast<std::size_t>(found - plan.problems.begin());
  std::vector<MethodFacts> all;
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    const StudyOptimizer& optimizer = plan.optimizers[o];
    const Cell cell{p, o, 1};
    const ProblemDescription& description = get_problem(plan, cell).problem->description();
    MethodFacts facts;
    facts.schedule = get_schedule(plan, cell);
    if (optimizer.row.capabilities.residuals && description.has_residuals) {
      facts.residuals = count_residuals(make_run_plan(plan, cell));
      facts.has_jacobian = uses_jacobian(optimizer, description);
    }
    facts.is_tuned_here = is_tuned_on(optimizer.row, found->loaded);
    add_runs(plan, *found, optimizer, cells, facts);
    all.push_back(std::move(facts));
  }
  return all;
}

std::string make_method_fields(const MethodFacts& facts) {
  const bool is_early = facts.early_runs > 0;
  const std::vector<std::string> reasons(facts.early_reasons.begin(), facts.early_reasons.end());
  return fmt::format("{},{},{},{},{},{},{},{},{}", to_text(facts.schedule), facts.residuals,
                     facts.has_jacobian ? 1 : 0, facts.judged ? format_exact(*facts.judged) : "",
                     facts.early_runs, is_early ? fmt::format("{}", facts.early_fewest_cases) : "",
                     is_early ? fmt::format("{}", facts.early_most_cases) : "",
                     quote_csv(join(reasons, "; ")), facts.is_tuned_here ? 1 : 0);
}

nlohmann::json method_to_json(const MethodFacts& facts) {
  nlohmann::json early = nullptr;
  if (facts.early_runs > 0) {
    early = {{"runs", facts.early_runs},
             {"cases", {facts.early_fewest_cases, facts.early_most_cases}},
             {"reasons", facts.early_reasons}};
  }
  return {{"schedule", to_text(facts.schedule)},
          {"residuals", facts.residuals},
          {"exact_jacobian", facts.has_jacobian},
          {"median_judged", facts.judged ? nlohmann::json(*facts.judged) : nlohmann::json()},
          {"ended_early", early},
          {"tuned_on_problem", facts.is_tuned_here}};
}

}  // namespace armwright
