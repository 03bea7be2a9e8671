// Merges cells of one study that were run in several folders, on machines without a common file
// system. Also removes the attempts that are no longer needed.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// Copies finished cells of the plan from `others` to the study if the study lacks them. Each cell
// is copied completely or not at all. Returns the number of copied cells; a stop ends the copying
// early. Checks everything before the first copy: throws Error{usage} for a folder that is not a
// study's. Throws Error{bad_data} that names cells which differ between two folders, or which were
// run with other settings.
std::size_t import_cells(const StudyPlan& plan, const std::filesystem::path& study,
                         std::span<const std::filesystem::path> others, StopSignal& stop);

// Removes the attempts at finished cells.
void remove_spent_attempts(const StudyPlan& plan, const std::filesystem::path& study);

}  // namespace armwright
