// What earlier attempts at a cell have evaluated, for a new one to go on with.
#pragma once

#include <filesystem>

#include "study/compare/study_plan.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// Makes the folder `run` a run that begins with what the furthest state of the cell has: its
// manifest and its journal, be it of an attempt, alive or not, or of an unfinished cell in its
// place. One that cannot be read is passed over, with a message: nothing but time is lost. Nothing
// is made if there is none. Error{io}.
void copy_furthest_state(const StudyPlan& plan, const Cell& cell,
                         const std::filesystem::path& study, const std::filesystem::path& run,
                         RunObserver& observer);

// For a local comparison, which holds the study: unfinished cells that attempts have begun get
// their furthest state in place. Attempts that are still alive are superseded by that.
void adopt_attempts(const StudyPlan& plan, const std::filesystem::path& study,
                    RunObserver& observer);

}  // namespace armwright
