// What tests of NLopt's rows look at: the points asked for and their values.
#pragma once

#include <span>
#include <vector>

#include "study/contract/memory_evaluator.hpp"

namespace armwright {

using Points = std::vector<std::vector<double>>;

inline Points asked_points(const MemoryEvaluator& evaluator) {
  Points points;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    points.push_back(entry.asked);
  }
  return points;
}

inline double calc_value(const Problem& problem, std::span<const double> x) {
  return problem.evaluate(x, {CaseRole::training, "train/test", {0}}).objectives.at(0);
}

}  // namespace armwright
