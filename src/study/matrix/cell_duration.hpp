// How long cells take, from a few simulations of each problem's start.
#pragma once

#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

// Of a cell of each problem, in one thread. An optimizer that thinks long takes longer.
std::vector<double> measure_cell_durations_s(const StudyPlan& plan);

// What one process that runs cells of the plan holds at most, beside what optimizers remember and
// what plugins take in processes of their own (docs/clusters.md).
double estimate_cell_memory_mib(const StudyPlan& plan);

}  // namespace armwright
