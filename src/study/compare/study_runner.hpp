// Runs the cells of a study, several at a time, each in a worker process. If a library crashes, the
// study loses one cell and goes on. The results depend neither on the number of processes nor on
// which process runs which cell.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "study/compare/cell.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

class Coordinator;

// Runs the cells of the plan that have no cell.json yet, in `jobs` processes. `observer` sees the
// training cases of the whole plan as progress. A stop ends the processes at once; their journals
// lack only the last moments. With a coordinator for the plan's problems (list_problems()) the
// coordinator simulates for all cells, and more than `jobs` cells run at a time. Returns how many
// cells did not end for a reason other than a decision of their optimizer; `observer` gets each
// reason as a message. Returns nothing if `stop` ended the run; the same command resumes it. Throws
// Error{io} and ends the study when a cell cannot write: the other cells use the same disk.
std::optional<std::size_t> run_cells(const StudyPlan& plan, const std::filesystem::path& study,
                                     unsigned jobs, StopSignal& stop, RunObserver& observer,
                                     Coordinator* coordinator = nullptr);

}  // namespace armwright
