// Finds the study and the cells that a command line names.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

// A study's folder and the plan that it records.
struct RecordedStudy {
  std::filesystem::path folder;
  StudyPlan plan;
};

// Loads the study of the folder `name`, or of the file `name` if that is a study.toml. Throws
// Error{usage} for any other path. Also throws Error{usage} if the recorded plan is resolved to
// another plan here, because an optimizer or armwright has another version. Starts no plugin and
// opens none, so the cells of plugins cannot run.
RecordedStudy load_recorded_study(const std::filesystem::path& name);
// The same for a study whose cells shall run. The plugins need consent
// (study/compare/plugin_consent.hpp).
RecordedStudy load_recorded_study(const std::filesystem::path& name, const AskUser& ask);

// Returns the cells that the words name, in the order given, each once. A word is one of
//   "3"                  the number of a cell, from 0, in the order of list_cells()
//   "3-9"                a range of numbers, both ends included
//   "q1-complex/ga/r03"  the name of a cell, which stays valid when the plan grows
// Throws Error{usage} for any other word.
std::vector<Cell> select_cells(const StudyPlan& plan, std::span<const std::string> words);

// Returns "q1-complex/ga/r03", with the labels written as in folder names.
std::string make_cell_name(const StudyPlan& plan, const Cell& cell);

}  // namespace armwright
