// The traffic lights: whether what is required is met, and which limit binds.
//
// With r = value / limit, as in the constraint g = r - 1:
//   met      green    r <= kMargin
//   tight    yellow   kMargin < r <= 1: met, but within 10 % of the limit
//   missed   red      r > 1
//   unknown  grey     no value, or r <= 1 and a case has no number: that one could be the worst
// The limit with the largest r of all that have a value binds.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

enum class RequirementGrade : std::uint8_t { met, tight, missed, unknown };
const char* to_string(RequirementGrade grade);  // "met", ...
const char* get_light(RequirementGrade grade);  // "green", ...

inline constexpr double kMargin = 0.9;

struct JudgedRequirement {
  RequiredMetric requirement;
  std::optional<double> value;
  std::optional<double> ratio;  // r
  RequirementGrade grade = RequirementGrade::unknown;
  bool binds = false;
};

// One value a requirement; `complete`: no case is without a number.
std::vector<JudgedRequirement> judge_requirements(std::span<const RequiredMetric> requirements,
                                                  std::span<const std::optional<double>> values,
                                                  bool complete);
// The same of an evaluation's metrics.
std::vector<JudgedRequirement> judge_requirements(std::span<const RequiredMetric> requirements,
                                                  const Evaluation& evaluation);

}  // namespace armwright
