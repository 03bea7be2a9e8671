// Finds the incumbents of a run in its journal. An incumbent was the best known design from a
// certain budget on, until a better one was found. The journal holds the designs themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "problems/interface/schedule.hpp"
#include "study/journal/journal.hpp"

namespace armwright {

struct Incumbent {
  std::int64_t cases = 0;  // charged to the budget when its evaluation was done
  std::uint64_t evaluation = 0;
  double objective = 0;  // in training
};

// Returns the incumbents in their order; only feasible evaluations count. With fixed training cases
// every strict improvement of the scalar objective is an incumbent. Values of different training cases
// cannot be compared: after each change of the cases the best design of that generation is the
// incumbent, from the end of that generation on.
std::vector<Incumbent> find_incumbents(const ProblemDescription& problem,
                                       const RecordedEvaluations& training,
                                       const Schedule& schedule);

// The largest number of incumbents of an arm that a cell simulates on the test set for its trace.
// More are rare with fixed cases. With fresh cases every generation has one.
inline constexpr std::size_t kMostTraced = 100;
// On functions the trace needs no simulation; the limit bounds the size of cell.json.
inline constexpr std::size_t kMostTracedOnFunctions = 10'000;

// Returns all incumbents if there are at most `most`. Otherwise returns those that were in force at
// `most` numbers of cases: logarithmically spaced from the first incumbent to the last, both
// included. A running time from the thinned list is late by at most one step, the factor
// (cases of the last / cases of the first)^(1 / (most - 1)); it is never early. The incumbents that
// were in force at `checkpoints` (ascending) are always among the result.
std::vector<Incumbent> thin_incumbents(std::span<const Incumbent> incumbents, std::size_t most,
                                       std::span<const std::int64_t> checkpoints);

}  // namespace armwright
