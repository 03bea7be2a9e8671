// Implements the analysis of fixed targets and of failing test cases.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "study/analysis/study_result.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

bool meets(const StudyTarget& target, const CurvePoint& point) {
  return (!target.value || point.value <= *target.value) &&
         (!target.failures ||
          (point.failures && *point.failures <= static_cast<std::uint64_t>(*target.failures)));
}

// Returns whether the first evaluation counts that meets a target. On arms, designs are chosen on
// the validation set, which is done at checkpoints.
bool uses_traces(const StudyPlan& plan, const ProblemResult& result) {
  const auto problem = std::ranges::find(plan.problems, result.label, &StudyProblem::label);
  return problem->loaded.tracking() == nullptr;
}

TargetTime make_time(const std::string& stream, std::vector<Trial> trials) {
  TargetTime time;
  time.trials = std::move(trials);
  time.expected = kInfinity;
  time.interval = {kInfinity, kInfinity};
  if (!time.trials.empty()) {
    time.reached = static_cast<int>(std::ranges::count_if(time.trials, &Trial::reached));
    time.expected = calc_expected_running_time(time.trials);
    time.interval =
        calc_resampled_running_time_interval(time.trials, kIntervalLevel, kResamples, stream);
  }
  return time;
}

}  // namespace

Trial make_target_trial(const StudyPlan& plan, const StudyTarget& target, const CellOutcome& cell,
                        std::span<const CurvePoint> points) {
  // A run that ended early has only spent its own cases, whether it reached the target or not.
  const std::int64_t spent = cell.cases > 0 ? static_cast<std::int64_t>(cell.cases) : plan.budget;
  const auto first =
      std::ranges::find_if(points, [&](const CurvePoint& point) { return meets(target, point); });
  if (first == points.end()) {
    return {.cost = static_cast<double>(spent), .reached = false};
  }
  return {.cost = static_cast<double>(std::min(first->budget, spent)), .reached = true};
}

void add_targets(const StudyPlan& plan, std::span<const std::vector<const CellOutcome*>> runs,
                 bool complete, ProblemResult& result) {
  for (std::size_t t = 0; t < plan.targets.size(); ++t) {
    const StudyTarget& target = plan.targets[t];
    if (std::ranges::find(target.problems, result.label) == target.problems.end()) {
      continue;
    }
    result.fixed_targets.push_back(t);
    const bool is_exact = uses_traces(plan, result);
    const auto get_stream = [&](std::size_t o) {
      return fmt::format("analysis/{}/{}/target {}", result.label, plan.optimizers[o].label,
                         target.label);
    };
    for (std::size_t o = 0; o < runs.size(); ++o) {
      std::vector<Trial> trials;
      for (const CellOutcome* run : runs[o]) {
        trials.push_back(
            make_target_trial(plan, target, *run, is_exact ? run->trace : run->choices));
      }
      TargetTime time = make_time(get_stream(o), std::move(trials));
      time.kept = static_cast<int>(std::ranges::count_if(runs[o], [&](const CellOutcome* run) {
        return !run->choices.empty() && meets(target, run->choices.back());
      }));
      result.optimizers[o].target_times.push_back(std::move(time));
    }
    const auto reference =
        std::ranges::find(plan.optimizers, plan.reference, &StudyOptimizer::label);
    if (plan.reference.empty() || !complete) {
      continue;
    }
    const auto& its_trials =
        result.optimizers[static_cast<std::size_t>(reference - plan.optimizers.begin())]
            .target_times.back()
            .trials;
    for (std::size_t o = 0; o < runs.size(); ++o) {
      TargetTime& time = result.optimizers[o].target_times.back();
      time.ratio = calc_running_time_ratio(time.trials, its_trials, kIntervalLevel, kResamples,
                                           get_stream(o) + "/ratio");
    }
  }
}

double calc_failure_share(const CellOutcome& cell) {
  return cell.errors.cases == 0
             ? kInfinity
             : static_cast<double>(cell.errors.failures) / static_cast<double>(cell.errors.cases);
}

CellOutcome count_failures_only(CellOutcome cell, const CaseSets& sets) {
  const auto share = [&](const std::optional<std::uint64_t>& failures) {
    return failures ? static_cast<double>(*failures) / sets.test_cases : kInfinity;
  };
  cell.value = calc_failure_share(cell);
  cell.start_value = share(cell.start_failures);
  for (CurvePoint& point : cell.curve) {
    point.value = share(point.failures);
  }
  for (CurvePoint& point : cell.trace) {
    point.value = share(point.failures);
  }
  return cell;
}

void add_failures(std::span<const std::vector<const CellOutcome*>> runs, bool complete,
                  ProblemResult& result) {
  std::vector<std::vector<double>> shares;
  for (std::size_t o = 0; o < runs.size(); ++o) {
    OptimizerResult& one = result.optimizers[o];
    for (const CellOutcome* run : runs[o]) {
      one.failure_shares.push_back(calc_failure_share(*run));
    }
    if (one.failure_shares.empty()) {
      one.failure_spread = {kInfinity, kInfinity, kInfinity};
      one.mean_failure_share = kInfinity;
    } else {
      one.failure_spread = calc_spread(one.failure_shares);
      one.mean_failure_share =
          std::accumulate(one.failure_shares.begin(), one.failure_shares.end(), 0.0) /
          static_cast<double>(one.failure_shares.size());
    }
    shares.push_back(one.failure_shares);
  }
  if (complete) {
    result.failure_pairs = compare_pairs(shares);
    const std::vector<double> ranks = calc_ranking(make_blocks(shares)).mean_ranks;
    for (std::size_t o = 0; o < ranks.size(); ++o) {
      result.optimizers[o].failure_mean_rank = ranks[o];
    }
  }
}

}  // namespace armwright
