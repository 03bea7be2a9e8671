// One cell of a comparison run anew, from the recorded plan and into a folder of its own: the
// comparison's own cells stay as they are.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "study/compare/study_plan.hpp"

namespace armwright {

// "PROBLEM/OPTIMIZER/rNN", with labels as the plan has them or as folders are named. Error{usage}
// for a name that is in neither way a cell of the plan's, or in two ways.
Cell find_cell(const StudyPlan& plan, std::string_view name);

// STUDY/reruns/PROBLEM/OPTIMIZER/rNN, or the first of rNN-002, rNN-003, ... whose run has not come
// to its end: one that was interrupted goes on.
std::filesystem::path choose_rerun_folder(const std::filesystem::path& study, const StudyPlan& plan,
                                          const Cell& cell);

// Whether the run of a cell in a folder has come to its end.
bool has_ended(const std::filesystem::path& folder);

}  // namespace armwright
