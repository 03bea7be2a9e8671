#include "problems/tracking/requirement_grade.hpp"

#include <algorithm>

namespace armwright {
namespace {

// The largest ratio r that is graded as met.
constexpr double kMostMet = 0.9;

RequirementGrade calc_grade(std::optional<double> ratio, bool complete) {
  if (ratio && *ratio > 1) {
    return RequirementGrade::missed;
  }
  if (!ratio || !complete) {
    return RequirementGrade::unknown;
  }
  return *ratio > kMostMet ? RequirementGrade::tight : RequirementGrade::met;
}

}  // namespace

const char* to_string(RequirementGrade grade) {
  switch (grade) {
    case RequirementGrade::met:
      return "met";
    case RequirementGrade::tight:
      return "tight";
    case RequirementGrade::missed:
      return "missed";
    case RequirementGrade::unknown:
      break;
  }
  return "unknown";
}

const char* get_light(RequirementGrade grade) {
  switch (grade) {
    case RequirementGrade::met:
      return "green";
    case RequirementGrade::tight:
      return "yellow";
    case RequirementGrade::missed:
      return "red";
    case RequirementGrade::unknown:
      break;
  }
  return "grey";
}

std::vector<JudgedRequirement> judge_requirements(std::span<const RequiredMetric> requirements,
                                                  std::span<const std::optional<double>> values,
                                                  bool complete) {
  std::vector<JudgedRequirement> judged;
  for (std::size_t i = 0; i < requirements.size(); ++i) {
    JudgedRequirement& one = judged.emplace_back();
    one.requirement = requirements[i];
    one.value = values[i];
    if (one.value) {
      one.ratio = *one.value / requirements[i].limit.value;
    }
    one.grade = calc_grade(one.ratio, complete);
  }
  const auto binding = std::ranges::max_element(judged, {}, &JudgedRequirement::ratio);
  if (binding != judged.end() && binding->ratio) {
    binding->binds = true;
  }
  return judged;
}

std::vector<JudgedRequirement> judge_requirements(std::span<const RequiredMetric> requirements,
                                                  const Evaluation& evaluation) {
  std::vector<std::optional<double>> values;
  for (const RequiredMetric& requirement : requirements) {
    const bool has_value = requirement.metric < evaluation.metrics.size();
    values.push_back(has_value ? std::optional(evaluation.metrics[requirement.metric])
                               : std::nullopt);
  }
  return judge_requirements(requirements, values, evaluation.failed_cases == 0);
}

}  // namespace armwright
