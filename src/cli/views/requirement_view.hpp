// The requirements on an arm, and whether a design meets them, as tables and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/terminal/terminal.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {

// A judged requirement and the place of its worst value, as far as the place is known.
struct ShownRequirement {
  JudgedRequirement judged;
  std::optional<std::uint64_t> worst_case = {};  // the case's number in its set, from 0
  std::optional<std::size_t> worst_point = {};
  std::optional<std::string> worst_joint = {};
};

// Judges each requirement on the worst of the cases that have a number. Returns an empty list if
// the problem has no requirements.
std::vector<ShownRequirement> judge_evaluation(const TrackingProblem& problem,
                                               const DesignEvaluation& evaluation);

// Returns a table with one row per requirement. It has a column of places if a place is known.
std::string format_requirements(std::span<const ShownRequirement> requirements, const Style& style);
// Returns the limit with its unit: "5 %", "0.2 s".
std::string describe_limit(const Limit& limit);

nlohmann::json requirements_to_json(std::span<const ShownRequirement> requirements);

// Returns whether a requirement that is also a constraint is missed.
bool is_constraint_missed(std::span<const ShownRequirement> requirements);

}  // namespace armwright
