// Runs the cells of a study, several at a time, each in a process of its own: a library that
// crashes takes one cell with it, not the study. Results do not depend on how many processes there
// are, nor on which of them does what.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/compare/cell.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

class Coordinator;

// A cell that did not come to its end, through no decision of its optimizer's.
struct BrokenCell {
  Cell cell;
  std::string reason;
};

struct CellsResult {
  bool stopped = false;  // by `stop`: the rest can be gone on with
  std::vector<BrokenCell> broken;
};

// Those of the plan's cells that have no cell.json yet. Progress counts training cases of the whole
// plan. A stop ends the processes at once; their journals have all but the last moments. Error{io}
// ends the study: what fills one cell's disk fills all. With a coordinator for the plan's problems
// (list_problems()) it simulates for all cells, of which more are then under way than `jobs`.
CellsResult run_cells(const StudyPlan& plan, const std::filesystem::path& study, unsigned jobs,
                      StopSignal& stop, RunObserver& observer, Coordinator* coordinator = nullptr);

}  // namespace armwright
