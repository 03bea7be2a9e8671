// Simulates the best design of every optimizer and problem again, on the test set and another
// engine. A comparison on a fast engine alone cannot show whether designs only work on that engine.
#pragma once

#include "study/analysis/study_result.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// Returns the cell of the replicate whose winner is best on the validation set. Returns null if no
// replicate has a winner. Points into `cells`.
const CellOutcome* find_best_cell(std::span<const CellOutcome> cells, const std::string& problem,
                                  const std::string& optimizer);

// Adds the recorded checks to `result` without simulating anything. Throws Error{bad_data} for a
// record that cannot be read.
void load_final_checks(const StudyPlan& plan, const std::filesystem::path& study,
                       StudyResult& result);
// Adds OptimizerResult::final_check wherever the plan has a final engine and the problem has an
// arm. Each check is stored in final/PROBLEM/OPTIMIZER.json and not repeated for the same design.
// Returns false if stopped. Throws Error{bad_data} or Error{io}.
bool add_final_checks(const StudyPlan& plan, const std::filesystem::path& study, unsigned jobs,
                      StopSignal& stop, RunObserver& observer, StudyResult& result);

}  // namespace armwright
