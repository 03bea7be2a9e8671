// The best design of every optimizer and problem once more, on the test set and another engine: a
// comparison on a quick engine says nothing of designs that only live there.
#pragma once

#include "study/analysis/study_result.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// The replicate whose winner is best on the validation set; null if none has one.
const CellOutcome* find_best_cell(std::span<const CellOutcome> cells, const std::string& problem,
                                  const std::string& optimizer);

// Adds those that are recorded, and simulates nothing.
void load_final_checks(const StudyPlan& plan, const std::filesystem::path& study,
                       StudyResult& result);
// Adds OptimizerResult::final_check where the plan has a final engine and the problem an arm. What
// was simulated is kept in final/PROBLEM/OPTIMIZER.json and not made again for the same design.
// False if stopped.
bool add_final_checks(const StudyPlan& plan, const std::filesystem::path& study, unsigned jobs,
                      StopSignal& stop, RunObserver& observer, StudyResult& result);

}  // namespace armwright
