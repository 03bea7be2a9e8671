// What is required of an arm, and whether a design keeps it, as tables and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/terminal/terminal.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {

// Where a requirement has its value: "case 12, point 3", "case 7, joint_2"; or nothing known.
struct WorstPlace {
  std::optional<std::uint64_t> case_number;
  std::optional<std::size_t> point;
  std::optional<std::string> joint;
};

struct ShownRequirement {
  JudgedRequirement judged;
  WorstPlace worst;
};

// Judged on the worst of the cases that have a number. Empty if the problem requires nothing.
std::vector<ShownRequirement> judge_evaluation(const TrackingProblem& problem,
                                               const DesignEvaluation& evaluation);

// Titles and a line each; the column of places only where they are known.
std::string format_requirements(std::span<const ShownRequirement> requirements, const Style& style);
// "5 %", "0.2 s".
std::string describe_limit(const Limit& limit);

nlohmann::json requirements_to_json(std::span<const ShownRequirement> requirements);

// A requirement that is used as a constraint is missed.
bool is_constraint_missed(std::span<const ShownRequirement> requirements);

}  // namespace armwright
