// Cells of a study as they are named on a command line.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

// "3": the number of a cell, from 0, in the order of list_cells(); "3-9": from one to another, both
// included; "q1-complex/ga/r03": its name, which stays right when the plan grows. In the order
// given, each once. Error{usage}.
std::vector<Cell> select_cells(const StudyPlan& plan, std::span<const std::string> words);

// "q1-complex/ga/r03", with labels as folders are named.
std::string make_cell_name(const StudyPlan& plan, const Cell& cell);

}  // namespace armwright
