// Finds the incumbents of a run in its journal. An incumbent was the best known design from a
// certain budget on, until a better one was found. The journal holds the designs themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "study/journal/journal.hpp"

namespace armwright {

struct Incumbent {
  std::int64_t cases = 0;  // charged to the budget when its evaluation was done
  std::uint64_t evaluation = 0;
  double objective = 0;  // in training
};

// Returns the incumbents in their order; only feasible evaluations count. With fixed training cases
// every strict improvement of the scalar objective is an incumbent. With `fresh` training cases
// values of different generations cannot be compared. There the best design of each generation is
// the incumbent, from the end of that generation on.
std::vector<Incumbent> find_incumbents(const ProblemDescription& problem,
                                       const RecordedEvaluations& training, bool fresh);

}  // namespace armwright
