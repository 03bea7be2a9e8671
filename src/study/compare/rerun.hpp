// Finds the cell and the folder for running one cell of a comparison again from the recorded plan.
// The new run has a folder of its own, so the comparison's cells stay as they are.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "study/compare/study_plan.hpp"

namespace armwright {

// Returns the cell with the name "PROBLEM/OPTIMIZER/rNN". Labels may be written as in the plan or
// as in folder names. Throws Error{usage} if the name fits no cell of the plan, or two cells.
Cell find_cell(const StudyPlan& plan, std::string_view name);

// Returns STUDY/reruns/PROBLEM/OPTIMIZER/rNN, or the first of rNN-002, rNN-003, ... that does not
// hold a finished run. An interrupted run is therefore resumed. Creates nothing.
std::filesystem::path choose_rerun_folder(const std::filesystem::path& study, const StudyPlan& plan,
                                          const Cell& cell);

// Returns whether the folder holds a cell's run that has ended.
bool has_ended(const std::filesystem::path& folder);

}  // namespace armwright
