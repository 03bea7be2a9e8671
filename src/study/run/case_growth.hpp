// Decides when a run gets more training cases (schedule `growing`). All candidates between two growths
// have the same first K cases: a stage. At the beginning of a generation the cases grow if both hold:
//   - the stage has had more than w evaluations. w is the number of evaluations of the last
//     generation, and at least 3 n, n the number of decision variables. For an optimizer without
//     generations that asks for more cases when it makes no progress, w is the number of evaluations
//     since it last asked,
//   - the best objective has improved by less than its noise over the last w evaluations,
//       b_(t-w) - b_t < s / sqrt(K),
//     where s is the standard deviation of the objectives that the best design would have on each of
//     its K cases alone (Problem::calc_case_objectives). One case has no deviation and always grows.
// What is gained within the noise between cases may be a gain on these cases alone, and one that other
// cases take back. Then K becomes max(K + 1, K FACTOR), rounded, but at most the cases that the problem
// has, and only if the budget pays for n + 1 evaluations on them.
//
// The state depends only on the evaluations, so it can be replayed.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

class CaseGrowth {
 public:
  explicit CaseGrowth(const RunPlan& plan);  // its problem must outlive the growth

  int cases() const { return cases_; }  // K
  // Adds a finished evaluation of the stage, with its objective; infinity if it is not feasible.
  void add(const EvaluationRecord& record, double objective);
  // To be called at the beginning of a generation. Returns true if the cases have grown.
  bool grow(std::uint64_t cases_left);

 private:
  const Problem& problem_;
  double factor_;
  std::size_t least_window_;
  int cases_, most_;
  std::vector<double> best_;             // per evaluation of the stage, the best objective so far
  std::vector<double> case_objectives_;  // of the best design
  std::size_t generation_begin_ = 0;
};

}  // namespace armwright
