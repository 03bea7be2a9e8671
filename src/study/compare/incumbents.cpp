#include "study/compare/incumbents.hpp"

#include <optional>
#include <utility>

namespace armwright {

std::vector<Incumbent> find_incumbents(const ProblemDescription& problem,
                                       const RecordedEvaluations& training, bool fresh) {
  std::vector<Incumbent> incumbents;
  std::optional<Incumbent> best;
  std::uint64_t generation = 0;
  std::int64_t cases = 0;
  const auto end_generation = [&] {
    if (best) {
      best->cases = cases;
      incumbents.push_back(*std::exchange(best, std::nullopt));
    }
  };
  for (const EvaluationRecord& record : training) {
    if (fresh && record.generation != generation) {
      end_generation();
      generation = record.generation;
    }
    cases += static_cast<std::int64_t>(record.calc_charge());
    if (!is_feasible(record.evaluation)) {
      continue;
    }
    const double objective = calc_scalar(problem, record.evaluation.objectives);
    if (best && best->objective <= objective) {
      continue;
    }
    best = Incumbent{cases, record.index, objective};
    if (!fresh) {
      incumbents.push_back(*best);
    }
  }
  if (fresh) {
    end_generation();
  }
  return incumbents;
}

}  // namespace armwright
