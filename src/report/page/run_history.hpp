// How a run went, from its journal: generation by generation, or of an optimizer without them block
// by block of consecutive evaluations. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/evidence/recorded_run.hpp"
#include "study/compare/incumbents.hpp"

namespace armwright {

// Consecutive evaluations of a journal's training.
struct HistoryPart {
  std::uint64_t index = 0;  // of the generation, or number of the last evaluation, from 1
  std::int64_t cases = 0;   // of the budget, at its end
  std::size_t first = 0;    // of the recorded ones, by number
  std::size_t count = 0;
};

struct History {
  bool by_generation = false;
  std::size_t left_out = 0;  // generations, of more than can be shown
  std::vector<HistoryPart> parts;
};

// At most 1000 generations, every n-th and the last, or 400 blocks of the same length.
History divide_history(const RecordedEvaluations& training);

// At most `most` of them, evenly spread, the first and the last included.
std::vector<Incumbent> thin_out(const std::vector<Incumbent>& incumbents, std::size_t most);

// Training, with `incumbents` as they are to be shown.
nlohmann::json make_training(const RecordedRun& run, const History& history,
                             nlohmann::json incumbents);
// A list of VariableHistory; empty if the problem is not known.
nlohmann::json make_variables(const RecordedRun& run, const History& history);
// RunFront, or null of a single objective.
nlohmann::json make_front(const RecordedRun& run);

}  // namespace armwright
