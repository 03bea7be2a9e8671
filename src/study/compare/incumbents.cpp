#include "study/compare/incumbents.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace armwright {
namespace {

// Returns how many incumbents were found within so many cases.
std::size_t count_found(std::span<const Incumbent> incumbents, double cases) {
  const auto after = std::ranges::upper_bound(
      incumbents, cases, {}, [](const Incumbent& one) { return static_cast<double>(one.cases); });
  return static_cast<std::size_t>(after - incumbents.begin());
}

}  // namespace

std::vector<Incumbent> find_incumbents(const ProblemDescription& problem,
                                       const RecordedEvaluations& training,
                                       const Schedule& schedule) {
  std::vector<Incumbent> incumbents;
  std::optional<Incumbent> best;
  std::uint64_t generation = 0;
  std::size_t cases_each = 0;
  bool is_first = schedule.renews_cases();  // generation on these cases
  std::int64_t cases = 0;
  const auto end_generation = [&] {
    if (is_first && best) {
      best->cases = cases;
      incumbents.push_back(*best);
    }
    is_first = false;
  };
  for (const EvaluationRecord& record : training) {
    if (schedule.changes_cases() && record.generation != generation) {
      end_generation();
      generation = record.generation;
      if (schedule.renews_cases()) {
        best.reset();
        is_first = true;
      }
    }
    cases += static_cast<std::int64_t>(record.calc_charge());
    if (!is_feasible(record.evaluation)) {
      continue;
    }
    if (schedule.kind == Schedule::Kind::growing && record.cases.numbers.size() != cases_each) {
      cases_each = record.cases.numbers.size();
      best.reset();
      is_first = true;
    }
    const double objective = calc_scalar(problem, record.evaluation.objectives);
    if (best && best->objective <= objective) {
      continue;
    }
    best = Incumbent{cases, record.index, objective};
    if (!is_first) {
      incumbents.push_back(*best);
    }
  }
  end_generation();
  return incumbents;
}

std::vector<Incumbent> thin_incumbents(std::span<const Incumbent> incumbents, std::size_t most,
                                       std::span<const std::int64_t> checkpoints) {
  if (incumbents.size() <= most) {
    return {incumbents.begin(), incumbents.end()};
  }
  std::vector<bool> kept(incumbents.size(), false);
  const auto keep = [&](double cases) {
    if (const std::size_t found = count_found(incumbents, cases); found > 0) {
      kept[found - 1] = true;
    }
  };
  const auto first = static_cast<double>(incumbents.front().cases);
  const auto last = static_cast<double>(incumbents.back().cases);
  for (std::size_t i = 0; i + 1 < most; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(most - 1);
    keep(first * std::pow(last / first, share));
  }
  kept.front() = kept.back() = true;  // whatever pow() rounds
  for (const std::int64_t budget : checkpoints) {
    keep(static_cast<double>(budget));
  }
  std::vector<Incumbent> thinned;
  for (std::size_t i = 0; i < incumbents.size(); ++i) {
    if (kept[i]) {
      thinned.push_back(incumbents[i]);
    }
  }
  return thinned;
}

}  // namespace armwright
