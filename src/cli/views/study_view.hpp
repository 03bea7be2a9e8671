// A comparison as `armwright compare` shows it: the plan before anything runs, tables and verdict
// when all has.
#pragma once

#include <string>

#include "cli/terminal/terminal.hpp"
#include "study/analysis/study_result.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {

// Problems, optimizers, and what is paired.
std::string describe_plan(const StudyPlan& plan);
// Cells, simulated cases, and how long it may take.
std::string describe_cost(const StudyPlan& plan, double expected_s, unsigned jobs);

// A table a problem, the ranking over problems, the verdict.
std::string describe_study(const StudyPlan& plan, const StudyResult& result,
                           const std::filesystem::path& folder, const Style& style);

}  // namespace armwright
