// Writes a study's tables about targets, choices and failures.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "study/analysis/study_tables.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json interval_to_json(const Interval& interval) {
  return {value_to_json(interval.lower), value_to_json(interval.upper)};
}

double calc_share(const TargetTime& time) {
  return time.trials.empty()
             ? 0
             : static_cast<double>(time.reached) / static_cast<double>(time.trials.size());
}

}  // namespace

std::string make_targets_table(const StudyPlan& plan, const StudyResult& result) {
  std::string csv =
      "problem,target,value_at_most,failures_at_most,optimizer,reached,kept,runs,success_share,"
      "expected_cases,lower_95,upper_95,reference,ratio,ratio_lower_95,ratio_upper_95\n";
  for (const ProblemResult& problem : result.problems) {
    for (std::size_t t = 0; t < problem.fixed_targets.size(); ++t) {
      const StudyTarget& target = plan.targets[problem.fixed_targets[t]];
      for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
        const TargetTime& time = problem.optimizers[o].target_times[t];
        csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", quote_csv(problem.label),
                           quote_csv(target.label), target.value ? format_exact(*target.value) : "",
                           target.failures ? std::to_string(*target.failures) : "",
                           quote_csv(plan.optimizers[o].label), time.reached, time.kept,
                           time.trials.size(), format_exact(calc_share(time)),
                           format_exact(time.expected), format_exact(time.interval.lower),
                           format_exact(time.interval.upper), quote_csv(plan.reference));
        if (const auto& ratio = time.ratio) {
          csv +=
              fmt::format(",{},{},{}\n", ratio->ratio ? format_exact(*ratio->ratio) : "",
                          format_exact(ratio->interval.lower), format_exact(ratio->interval.upper));
        } else {
          csv += ",,,\n";
        }
      }
    }
  }
  return csv;
}

std::string make_choices_table(const StudyResult& result) {
  std::string csv = "problem,optimizer,replicate,cases,value,failures\n";
  for (const CellOutcome& cell : result.cells) {
    for (const CurvePoint& point : cell.choices) {
      csv += fmt::format("{},{},{},{},{},{}\n", quote_csv(cell.problem), quote_csv(cell.optimizer),
                         cell.replicate, point.budget, format_exact(point.value),
                         point.failures ? std::to_string(*point.failures) : "");
    }
  }
  return csv;
}

std::string make_failures_table(const StudyPlan& plan, const StudyResult& result) {
  std::string csv =
      "problem,optimizer,runs,test_cases,runs_without_failure,mean_share,median_share,"
      "lower_quartile,upper_quartile\n";
  for (std::size_t p = 0; p < result.problems.size(); ++p) {
    const ProblemResult& problem = result.problems[p];
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      const OptimizerResult& one = problem.optimizers[o];
      if (one.failure_shares.empty()) {
        continue;
      }
      csv += fmt::format(
          "{},{},{},{},{},{},{},{},{}\n", quote_csv(problem.label),
          quote_csv(plan.optimizers[o].label), one.failure_shares.size(),
          plan.problems[p].loaded.sets.test_cases, std::ranges::count(one.failure_shares, 0.0),
          format_exact(one.mean_failure_share), format_exact(one.failure_spread.median),
          format_exact(one.failure_spread.lower_quartile),
          format_exact(one.failure_spread.upper_quartile));
    }
  }
  return csv;
}

json target_times_to_json(const StudyPlan& plan, const ProblemResult& problem,
                          const OptimizerResult& one) {
  json list = json::array();
  for (std::size_t t = 0; t < problem.fixed_targets.size(); ++t) {
    const StudyTarget& target = plan.targets[problem.fixed_targets[t]];
    const TargetTime& time = one.target_times[t];
    json entry = {{"target", target.label},
                  {"value", target.value ? json(*target.value) : json()},
                  {"failures", target.failures ? json(*target.failures) : json()},
                  {"reached", time.reached},
                  {"kept", time.kept},
                  {"runs", time.trials.size()},
                  {"expected_cases", value_to_json(time.expected)},
                  {"interval", interval_to_json(time.interval)},
                  {"ratio", nullptr},
                  {"ratio_interval", nullptr}};
    if (const auto& ratio = time.ratio) {
      entry["ratio"] = ratio->ratio ? value_to_json(*ratio->ratio) : json();
      entry["ratio_interval"] = interval_to_json(ratio->interval);
    }
    list.push_back(std::move(entry));
  }
  return list;
}

json failures_to_json(const OptimizerResult& one) {
  if (one.failure_shares.empty()) {
    return nullptr;
  }
  json shares = json::array();
  for (const double share : one.failure_shares) {
    shares.push_back(value_to_json(share));
  }
  return {{"shares", std::move(shares)},
          {"mean", value_to_json(one.mean_failure_share)},
          {"median", value_to_json(one.failure_spread.median)}};
}

}  // namespace armwright
