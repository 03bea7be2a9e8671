// Implements analyze_overall() and analyze_study(): the statistics over all problems.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/folder_checksums.hpp"
#include "study/analysis/study_result.hpp"
#include "study/statistics/running_time.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

std::vector<double> make_grid(double first, double last, int steps) {
  std::vector<double> grid;
  for (int i = 0; i <= steps; ++i) {
    grid.push_back(first * std::pow(last / first, static_cast<double>(i) / steps));
  }
  return grid;
}

double calc_share_left(const ProblemResult& problem, double median) {
  if (problem.has_front || !std::isfinite(median)) {
    return median;  // already a share, or infinite
  }
  const double way = problem.start - problem.best_known;
  return way > 0 ? (median - problem.best_known) / way : 0;
}

// Returns the share that is left by the first optimizer whose median rounds to the same number.
// Medians that count as equal so leave the same share.
double calc_rounded_share(const ProblemResult& problem, std::size_t optimizer) {
  const auto round = [&](const OptimizerResult& one) {
    return problem.margin.round(one.spread.median);
  };
  const auto first =
      std::ranges::find(problem.optimizers, round(problem.optimizers[optimizer]), round);
  return calc_share_left(problem, first->spread.median);
}

// The costs, in evaluations, of every optimizer to converge on every (problem, replicate).
struct Costs {
  std::vector<std::vector<double>> table;
  std::vector<int> dimensions;
};

Costs calc_costs(const StudyPlan& plan, std::span<const CellOutcome> cells, double tolerance) {
  Costs costs;
  const auto optimizers = plan.optimizers.size();
  const auto replicates = static_cast<std::size_t>(plan.replicates);
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const StudyProblem& problem = plan.problems[p];
    for (std::size_t r = 0; r < replicates; ++r) {
      const auto get_cell = [&](std::size_t o) -> const CellOutcome& {
        return cells[(p * optimizers + o) * replicates + r];
      };
      double best = kInfinity;
      double start = kInfinity;
      for (std::size_t o = 0; o < optimizers; ++o) {
        start = std::min(start, get_cell(o).start_value);  // infinite for missing cells
        const CellOutcome& cell = get_cell(o);
        for (const CurvePoint& point : cell.trace) {
          best = std::min(best, point.value);
        }
      }
      const double target = calc_convergence_target(start, best, tolerance);
      std::vector<double> row;
      for (std::size_t o = 0; o < optimizers; ++o) {
        const double cases = calc_cost_to_target(make_trace(get_cell(o)), target);
        row.push_back(cases / problem.schedule.cases);
      }
      costs.table.push_back(std::move(row));
      costs.dimensions.push_back(
          static_cast<int>(problem.loaded.problem->description().variables.size()));
    }
  }
  return costs;
}

// Makes the outcome of a cell that has not ended: its optimizer counts as having found nothing.
CellOutcome make_missing(const StudyPlan& plan, const Cell& cell) {
  CellOutcome outcome;
  outcome.problem = plan.problems[cell.problem].label;
  outcome.optimizer = plan.optimizers[cell.optimizer].label;
  outcome.optimizer_name = plan.optimizers[cell.optimizer].row.name;
  outcome.replicate = cell.replicate;
  outcome.end_reason = kNotEnded;
  outcome.value = outcome.validation_value = outcome.start_value = kInfinity;
  for (const std::int64_t budget : list_checkpoints(plan, cell.problem)) {
    outcome.curve.push_back({budget, kInfinity, std::nullopt});
  }
  return outcome;
}

}  // namespace

OverallResult analyze_overall(const StudyPlan& plan, std::span<const ProblemResult> problems,
                              std::span<const CellOutcome> cells) {
  OverallResult overall;
  std::vector<std::vector<double>> rounded;  // medians, one row per problem
  std::vector<std::vector<double>> shares(plan.optimizers.size());
  std::vector<std::vector<double>> rounded_shares(plan.optimizers.size());
  for (const ProblemResult& problem : problems) {
    auto& row = rounded.emplace_back();
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      const double median = problem.optimizers[o].spread.median;
      row.push_back(problem.margin.round(median));
      shares[o].push_back(calc_share_left(problem, median));
      rounded_shares[o].push_back(calc_rounded_share(problem, o));
    }
  }
  overall.ranking = calc_ranking_stability(rounded);
  if (rounded.size() > 1 && plan.optimizers.size() > 1) {
    overall.friedman = calc_friedman_test(rounded);
  }
  if (rounded.size() > 1) {
    const auto is_equal = [&](std::size_t o, std::size_t other, std::size_t p) {
      const auto& optimizers = problems[p].optimizers;
      return problems[p].margin.is_equal(optimizers[o].spread.median,
                                         optimizers[other].spread.median);
    };
    overall.pairs = compare_pairs(shares, rounded_shares, is_equal);
  }
  constexpr double kMostTimes = 100;
  constexpr int kSteps = 40;
  overall.alphas = make_grid(1, kMostTimes, kSteps);
  double most = 1;
  double least = kInfinity;
  for (const StudyProblem& problem : plan.problems) {
    const auto n = static_cast<double>(problem.loaded.problem->description().variables.size());
    most = std::max(most, static_cast<double>(plan.budget / problem.schedule.cases) / (n + 1));
    least = std::min(least, 1 / (n + 1));
  }
  overall.kappas = make_grid(least, most, kSteps);
  for (const double tolerance : kProfileTolerances) {
    const Costs costs = calc_costs(plan, cells, tolerance);
    overall.data_profiles.push_back(
        {tolerance, calc_data_profiles(costs.table, costs.dimensions, overall.kappas)});
    overall.performance_profiles.push_back(
        {tolerance, calc_performance_profiles(costs.table, overall.alphas)});
  }
  return overall;
}

namespace {

// Analyzes only the problems that have all their cells.
OverallResult analyze_complete(const StudyPlan& plan, const StudyResult& result) {
  StudyPlan complete = plan;
  complete.problems.clear();
  std::vector<ProblemResult> problems;
  std::vector<CellOutcome> cells;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    if (std::ranges::find(result.missing, p, &Cell::problem) != result.missing.end()) {
      continue;
    }
    complete.problems.push_back(plan.problems[p]);
    problems.push_back(result.problems[p]);
    std::ranges::copy_if(result.cells, std::back_inserter(cells), [&](const CellOutcome& cell) {
      return cell.problem == plan.problems[p].label;
    });
  }
  return problems.empty() ? OverallResult{} : analyze_overall(complete, problems, cells);
}

}  // namespace

StudyResult analyze_study(const StudyPlan& plan, const std::filesystem::path& study,
                          MissingCells missing) {
  const FolderChecksums checksums(study);
  StudyResult result;
  result.missing_left_out = missing == MissingCells::left_out;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const std::size_t first = result.cells.size();
    for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
      for (int r = 1; r <= plan.replicates; ++r) {
        const Cell cell{p, o, r};
        auto outcome = load_cell(plan, cell, study);
        if (!outcome) {
          result.missing.push_back(cell);
          if (result.missing_left_out) {
            continue;
          }
          outcome = make_missing(plan, cell);
        } else {
          checksums.check((make_cell_path(plan, cell) / kChecksumFile).string());
          outcome->judged = count_judged(study / make_cell_path(plan, cell));
        }
        if (plan.value == StudyValue::failures) {
          outcome = count_failures_only(std::move(*outcome), plan.problems[p].loaded.sets);
        }
        result.cells.push_back(std::move(*outcome));
      }
    }
    result.problems.push_back(
        analyze_problem(plan, p, std::span<const CellOutcome>(result.cells).subspan(first)));
  }
  result.overall = result.missing_left_out ? analyze_complete(plan, result)
                                           : analyze_overall(plan, result.problems, result.cells);
  return result;
}

}  // namespace armwright
