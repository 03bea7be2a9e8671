// The grades of requirements: whether each limit is kept, and which limit binds.
//
// With r = value / limit, as in the constraint g = r - 1:
//   met      green    r <= 0.9
//   tight    yellow   0.9 < r <= 1: met, but within 10 % of the limit
//   missed   red      r > 1
//   unknown  grey     no value; or r <= 1 although a case ended without a number, because that
//                     case could be the worst
// The requirement with the largest r binds; requirements without a value do not take part.
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

// A requirement with its value and its grade.
struct JudgedRequirement {
  RequiredMetric requirement;
  std::optional<double> value;
  std::optional<double> ratio;  // r
  RequirementGrade grade = RequirementGrade::unknown;
  bool binds = false;
};

// Grades the requirements. `values` has one value per requirement. `complete` is true if no
// case ended without a number.
std::vector<JudgedRequirement> judge_requirements(std::span<const RequiredMetric> requirements,
                                                  std::span<const std::optional<double>> values,
                                                  bool complete);
// Grades the requirements with the metrics of an evaluation.
std::vector<JudgedRequirement> judge_requirements(std::span<const RequiredMetric> requirements,
                                                  const Evaluation& evaluation);

}  // namespace armwright
