// The incumbents of a run, as its journal has them: the designs that were the best known for a
// while, and from what budget on. The designs themselves are in the journal.
#pragma once

#include <cstdint>
#include <vector>

#include "study/journal/journal.hpp"

namespace armwright {

struct Incumbent {
  std::int64_t cases = 0;  // of the budget, when its evaluation was done
  std::uint64_t evaluation = 0;
  double objective = 0;  // in training
};

// Of feasible evaluations: with fixed training cases every strict improvement of the scalar
// objective; with fresh ones, where values of different generations do not compare, the best of
// each generation, once that has ended.
std::vector<Incumbent> find_incumbents(const ProblemDescription& problem,
                                       const RecordedEvaluations& training, bool fresh);

}  // namespace armwright
