// What the parts of a study's analysis share. Internal to study/compare.
#pragma once

#include <span>
#include <vector>

#include "study/analysis/study_result.hpp"
#include "study/statistics/running_time.hpp"

namespace armwright {

// At each checkpoint the worst value on the test set from there on: what the run has for good. The
// best so far would be a selection on the test set, which profits from luck.
std::vector<TracePoint> make_trace(const CellOutcome& cell);

// Every two of the optimizers; values[o][i] and values[p][i] are a pair.
std::vector<PairResult> compare_pairs(std::span<const std::vector<double>> values);

// Fills in TargetTime and failure shares of all optimizers, whose cells are `runs[o]`. Pairs are
// compared if `complete`.
void add_targets(const StudyPlan& plan, std::span<const std::vector<const CellOutcome*>> runs,
                 bool complete, ProblemResult& result);
void add_failures(std::span<const std::vector<const CellOutcome*>> runs, bool complete,
                  ProblemResult& result);

}  // namespace armwright
