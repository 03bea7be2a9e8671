// Brings the cells of a study together that were run in folders of machines without a common file
// system, and clears away what attempts have left.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// Finished cells of the plan that are in others' folders and not in the study's are copied there,
// each whole or not at all. How many; less than there are if stopped. Before anything is copied:
// Error{usage} for a folder that is no study's; Error{bad_data} that names cells which differ
// between two folders, or that other settings were used for.
std::size_t import_cells(const StudyPlan& plan, const std::filesystem::path& study,
                         std::span<const std::filesystem::path> others, StopSignal& stop);

// Removes the attempts at cells that are done.
void remove_spent_attempts(const StudyPlan& plan, const std::filesystem::path& study);

}  // namespace armwright
