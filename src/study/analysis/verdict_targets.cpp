// Writes the verdict's sentences about targets.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "study/analysis/verdict.hpp"

namespace armwright {
namespace {

// The verdict points out ratios to the reference's expected running time up to this one.
constexpr double kFewSimulations = 0.1;

std::string format_cases(double cases) {
  return std::isfinite(cases) ? fmt::format("{:.0f}", cases) : "infinite";
}

std::string format_ratio(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2g}", ratio) : "infinite";
}

std::string describe_time(const StudyPlan& plan, const std::string& label, const TargetTime& time) {
  std::string text = fmt::format(
      "{} needs {} simulations (95 %: {} to {}; reached in {} of {} runs, kept to the end in {})",
      label, format_cases(time.expected), format_cases(time.interval.lower),
      format_cases(time.interval.upper), time.reached, time.trials.size(), time.kept);
  if (time.ratio && time.ratio->ratio && label != plan.reference) {
    text +=
        fmt::format(", {} times what {} needs (95 %: {} to {})", format_ratio(*time.ratio->ratio),
                    plan.reference, format_ratio(time.ratio->interval.lower),
                    format_ratio(time.ratio->interval.upper));
  }
  return text;
}

double count_spent(const TargetTime& time) {
  double spent = 0;
  for (const Trial& trial : time.trials) {
    spent += trial.cost;
  }
  return spent;
}

// Returns the labels of the optimizers whose target time meets the condition.
template <typename Condition>
std::string list_where(const StudyPlan& plan, const ProblemResult& result, std::size_t target,
                       Condition&& is_so) {
  std::vector<std::string> labels;
  for (std::size_t o = 0; o < result.optimizers.size(); ++o) {
    if (is_so(result.optimizers[o].target_times[target])) {
      labels.push_back(plan.optimizers[o].label);
    }
  }
  return join(labels, ", ");
}

std::vector<std::string> describe_one(const StudyPlan& plan, const StudyProblem& problem,
                                      const ProblemResult& result, std::size_t t) {
  const auto get_time = [&](std::size_t o) -> const TargetTime& {
    return result.optimizers[o].target_times[t];
  };
  const std::string where =
      fmt::format("To the target {} on {}",
                  describe_target(problem, plan.targets[result.fixed_targets[t]]), result.label);
  std::size_t best = 0;
  for (std::size_t o = 1; o < result.optimizers.size(); ++o) {
    best = get_time(o).expected < get_time(best).expected ? o : best;
  }
  if (!std::isfinite(get_time(best).expected)) {
    return {where + " no run of any optimizer came."};
  }
  std::vector<std::string> sentences = {fmt::format(
      "{} {}.", where, describe_time(plan, plan.optimizers[best].label, get_time(best)))};
  const auto reference = std::ranges::find(plan.optimizers, plan.reference, &StudyOptimizer::label);
  if (!plan.reference.empty() && reference != plan.optimizers.end()) {
    const auto r = static_cast<std::size_t>(reference - plan.optimizers.begin());
    sentences.push_back(get_time(r).reached == 0
                            ? fmt::format("{} did not come there in {:.0f} simulations ({} runs).",
                                          plan.reference, count_spent(get_time(r)),
                                          get_time(r).trials.size())
                            : describe_time(plan, plan.reference, get_time(r)) + ".");
    const std::string few = list_where(plan, result, t, [](const TargetTime& time) {
      return time.ratio && time.ratio->ratio && *time.ratio->ratio <= kFewSimulations;
    });
    const std::string surely = list_where(plan, result, t, [](const TargetTime& time) {
      return time.ratio && time.ratio->interval.upper <= kFewSimulations;
    });
    if (!few.empty()) {
      sentences.push_back(fmt::format("A tenth of {}'s or less: {}; with the whole interval: {}.",
                                      plan.reference, few, surely.empty() ? "none" : surely));
    }
  }
  const std::string never =
      list_where(plan, result, t, [](const TargetTime& time) { return time.reached == 0; });
  if (!never.empty()) {
    sentences.push_back("Reached by no run of: " + never + ".");
  }
  return sentences;
}

}  // namespace

std::string describe_target(const StudyProblem& problem, const StudyTarget& target) {
  std::vector<std::string> conditions;
  if (target.value) {
    const Quantity quantity = get_scalar_quantity(problem.loaded.problem->description().objectives);
    conditions.push_back(
        fmt::format("{} at most {:.4g}{}", quantity.name, *target.value,
                    quantity.unit == "1" || quantity.unit.empty() ? "" : " " + quantity.unit));
  }
  if (target.failures) {
    conditions.push_back(fmt::format("at most {} of {} test cases failing", *target.failures,
                                     problem.loaded.sets.test_cases));
  }
  return fmt::format("'{}' ({})", target.label, join(conditions, ", "));
}

std::vector<std::string> describe_target_verdict(const StudyPlan& plan, const StudyProblem& problem,
                                                 const ProblemResult& result) {
  std::vector<std::string> sentences;
  for (std::size_t t = 0; t < result.fixed_targets.size(); ++t) {
    const auto more = describe_one(plan, problem, result, t);
    sentences.insert(sentences.end(), more.begin(), more.end());
  }
  return sentences;
}

}  // namespace armwright
