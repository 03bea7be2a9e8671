// Implements analyze_problem(): the statistics of one problem.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "study/analysis/study_result.hpp"
#include "study/statistics/pareto.hpp"
#include "study/statistics/running_time.hpp"
#include "study/statistics/significance.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

constexpr int kEcdfTargets = 31;
constexpr double kEcdfDecades = 3;

// The common front of all runs, and what the fronts of single runs are measured with. Like the best
// known value, it depends on the optimizers that take part.
struct CommonFront {
  std::vector<std::vector<double>> points;
  std::vector<double> ideal;      // the least value of each objective
  std::vector<double> extent;     // of the front, per objective
  std::vector<double> reference;  // of the hypervolume: a tenth of the extent beyond the front
};

CommonFront find_common_front(std::span<const CellOutcome> cells, std::size_t objectives) {
  std::vector<std::vector<double>> all;
  for (const CellOutcome& cell : cells) {
    all.insert(all.end(), cell.front.begin(), cell.front.end());
  }
  CommonFront common{.points = {},
                     .ideal = std::vector<double>(objectives, 0),
                     .extent = std::vector<double>(objectives, 1),
                     .reference = std::vector<double>(objectives, 1)};
  const auto front = find_non_dominated(all);
  for (std::size_t k = 0; k < objectives && !front.empty(); ++k) {
    const auto by_objective = [&](std::size_t a, std::size_t b) { return all[a][k] < all[b][k]; };
    const auto [least, most] = std::ranges::minmax_element(front, by_objective);
    const double lower = all[*least][k];
    const double upper = all[*most][k];
    const double extent = upper > lower ? upper - lower : upper != 0 ? std::abs(upper) : 1;
    common.ideal[k] = lower;
    common.extent[k] = extent;
    common.reference[k] = upper + 0.1 * extent;
  }
  for (const std::size_t i : front) {
    if (std::ranges::find(common.points, all[i]) == common.points.end()) {
      common.points.push_back(all[i]);
    }
  }
  return common;
}

// Returns the share of the box from the ideal to the reference point that the front does not
// dominate.
double calc_missed_volume(const CellOutcome& cell, std::span<const double> ideal,
                          std::span<const double> reference) {
  double box = 1;
  for (std::size_t k = 0; k < ideal.size(); ++k) {
    box *= reference[k] - ideal[k];
  }
  return 1 - calc_hypervolume(cell.front, reference) / box;
}

// Returns target values between the best known and the start value. The share of the distance that
// is left decreases logarithmically.
std::vector<double> make_targets(double best, double start) {
  std::vector<double> targets;
  if (!std::isfinite(best) || !std::isfinite(start)) {
    return targets;
  }
  for (int i = 0; i < kEcdfTargets; ++i) {
    const double share = std::pow(10, -kEcdfDecades * i / (kEcdfTargets - 1));
    targets.push_back(calc_convergence_target(start, best, share));
  }
  return targets;
}

void set_best_and_start(std::span<const CellOutcome> cells, ProblemResult& result) {
  result.best_known = result.margin.optimum.value_or(kInfinity);
  double worst = -kInfinity;
  std::vector<double> starts;
  const auto meet = [&](double value) {
    result.best_known = std::min(result.best_known, value);
    worst = std::isfinite(value) ? std::max(worst, value) : worst;
  };
  for (const CellOutcome& cell : cells) {
    starts.push_back(cell.start_value);
    meet(result.has_front ? kInfinity : cell.value);
    for (const CurvePoint& point : cell.trace) {
      meet(point.value);
    }
  }
  result.start = starts.empty() ? kInfinity : calc_spread(starts).median;
  if (!std::isfinite(result.start) && std::isfinite(worst)) {
    result.start = worst;  // the only other measure of the distance
  }
}

void add_running_times(const StudyPlan& plan, const ProblemResult& problem,
                       std::span<const CellOutcome* const> runs, const std::string& stream,
                       OptimizerResult& result) {
  std::vector<std::vector<TracePoint>> traces;
  std::vector<double> times;  // one per pair of run and target
  for (const CellOutcome* run : runs) {
    traces.push_back(make_trace(*run));
    for (const double target : problem.targets) {
      times.push_back(calc_cost_to_target(traces.back(), target));
    }
  }
  const auto costs = std::vector<double>(problem.checkpoints.begin(), problem.checkpoints.end());
  const bool has_range = costs.size() > 1;
  if (!times.empty() && has_range) {
    result.ecdf = calc_runtime_ecdf(times, costs);
    result.anytime_area = calc_anytime_area(times, costs.front(), costs.back());
  } else {
    result.ecdf.assign(costs.size(), 0);
  }
  for (const double share : kRunningTimeTargets) {
    RunningTime time;
    time.expected = kInfinity;
    time.interval = {kInfinity, kInfinity};
    time.target = calc_convergence_target(problem.start, problem.best_known, share);
    std::vector<Trial> trials;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const double cost = calc_cost_to_target(traces[i], time.target);
      const bool reached = std::isfinite(cost);
      // A run that ended early has only spent its own cases, whether it reached the target or not.
      const double spent = runs[i]->cases > 0 ? static_cast<double>(runs[i]->cases)
                                              : static_cast<double>(plan.budget);
      trials.push_back({std::min(cost, spent), reached});
      time.reached += reached ? 1 : 0;
    }
    if (time.reached > 0) {
      time.expected = calc_expected_running_time(trials);
      time.interval = calc_resampled_running_time_interval(
          trials, kIntervalLevel, kResamples, fmt::format("{}/running time {}", stream, share));
    }
    result.running_times.push_back(time);
  }
}

void add_curve(const ProblemResult& problem, std::span<const CellOutcome* const> runs,
               OptimizerResult& result) {
  for (const std::int64_t budget : problem.checkpoints) {
    std::vector<double> values;
    for (const CellOutcome* run : runs) {
      const auto point = std::ranges::find(run->curve, budget, &CurvePoint::budget);
      values.push_back(point == run->curve.end() ? kInfinity : point->value);
    }
    result.curve.push_back(values.empty() ? Spread{kInfinity, kInfinity, kInfinity}
                                          : calc_spread(values));
  }
}

// Computes ranks, tests and pairs over the replicates.
void compare_optimizers(std::span<const std::vector<double>> values, ProblemResult& result) {
  const auto blocks = make_blocks(round_values(values, result.margin));
  const Ranking ranking = calc_ranking(blocks);
  for (std::size_t i = 0; i < values.size(); ++i) {
    result.optimizers[i].mean_rank = ranking.mean_ranks[i];
  }
  if (blocks.size() > 1 && values.size() > 1) {
    result.friedman = calc_friedman_test(blocks);
  }
  result.pairs = compare_pairs(values, result.margin);
}

}  // namespace

Margin make_margin(const StudyPlan& plan, const StudyProblem& problem) {
  const ProblemDescription& description = problem.loaded.problem->description();
  if (plan.value == StudyValue::failures || description.objectives.size() > 1) {
    return {};
  }
  const TrackingProblem* tracking = problem.loaded.tracking();
  return {.resolution = description.resolution,
          .logarithm = tracking != nullptr && tracking->config().objective.logarithm,
          .optimum = description.optimum};
}

std::vector<TracePoint> make_trace(const CellOutcome& cell) {
  std::vector<TracePoint> trace;
  double worst = -kInfinity;
  for (auto point = cell.trace.rbegin(); point != cell.trace.rend(); ++point) {
    worst = std::max(worst, point->value);
    trace.push_back({static_cast<double>(point->budget), worst});
  }
  std::ranges::reverse(trace);
  return trace;
}

std::vector<std::size_t> order_optimizers(std::span<const OptimizerResult> optimizers,
                                          bool complete) {
  std::vector<std::size_t> order(optimizers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    const OptimizerResult& one = optimizers[i];
    return std::tuple(complete ? one.mean_rank : 0, complete ? -one.successes : 0,
                      one.spread.median);
  });
  return order;
}

ProblemResult analyze_problem(const StudyPlan& plan, std::size_t number,
                              std::span<const CellOutcome> cells) {
  const StudyProblem& problem = plan.problems[number];
  const ProblemDescription& description = problem.loaded.problem->description();
  ProblemResult result;
  result.label = problem.label;
  result.has_front = description.objectives.size() > 1;
  if (plan.value == StudyValue::failures) {
    result.quantity = {"share of failed test cases", "1"};
  } else {
    result.quantity = result.has_front ? Quantity{"missed hypervolume", "1"}
                                       : get_scalar_quantity(description.objectives);
  }
  result.checkpoints = list_checkpoints(plan, number);
  result.margin = make_margin(plan, problem);
  set_best_and_start(cells, result);
  result.targets = make_targets(result.best_known, result.start);
  CommonFront common;
  if (result.has_front) {
    common = find_common_front(cells, description.objectives.size());
    result.reference_point = common.reference;
  }
  std::vector<std::vector<double>> values;
  std::vector<std::vector<const CellOutcome*>> all_runs;
  for (std::size_t i = 0; i < plan.optimizers.size(); ++i) {
    const std::string& label = plan.optimizers[i].label;
    const std::string stream = fmt::format("analysis/{}/{}", problem.label, label);
    std::vector<const CellOutcome*> runs;
    OptimizerResult one;
    std::vector<double> cases;
    for (const CellOutcome& cell : cells) {
      if (cell.optimizer != label) {
        continue;
      }
      runs.push_back(&cell);
      const double value =
          result.has_front ? calc_missed_volume(cell, common.ideal, common.reference) : cell.value;
      one.values.push_back(value);
      if (!common.points.empty()) {
        one.igd_plus.push_back(calc_igd_plus(cell.front, common.points, common.extent));
      }
      one.successes += result.margin.is_success(value) ? 1 : 0;
      one.infinite += std::isfinite(value) ? 0 : 1;
      one.infeasible += cell.violation > plan.constraint_tolerance ? 1 : 0;
      one.failed += cell.failure.empty() ? 0 : 1;
      const bool found_none =
          cell.x.empty() && cell.failure.empty() && cell.end_reason != kNotEnded;
      one.unmet += found_none || cell.violation > plan.constraint_tolerance ? 1 : 0;
      cases.push_back(static_cast<double>(cell.cases));
    }
    if (runs.empty()) {
      one.spread = {kInfinity, kInfinity, kInfinity};
      one.median_interval = {kInfinity, kInfinity};
    } else {
      one.spread = calc_spread(one.values);
      one.median_interval =
          calc_median_interval(one.values, kIntervalLevel, kResamples, stream + "/median");
      one.cases = calc_spread(cases).median;
    }
    add_running_times(plan, result, runs, stream, one);
    add_curve(result, runs, one);
    values.push_back(one.values);
    all_runs.push_back(std::move(runs));
    result.optimizers.push_back(std::move(one));
  }
  const bool complete = cells.size() == values.size() * static_cast<std::size_t>(plan.replicates);
  if (complete) {
    compare_optimizers(values, result);
  }
  add_targets(plan, all_runs, complete, result);
  if (problem.loaded.tracking()) {
    add_failures(all_runs, complete, result);
  }
  result.order = order_optimizers(result.optimizers, complete);
  return result;
}

}  // namespace armwright
