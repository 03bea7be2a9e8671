#include "optimizers/table/auto_probe.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/search_space.hpp"
#include "optimizers/interface/treated_problem.hpp"

namespace armwright {
namespace {

constexpr std::int64_t kLines = 2;
constexpr std::int64_t kFewestPoints = 10, kMostPoints = 25;  // per line
constexpr std::int64_t kShare = 20;                           // one evaluation in 20 is the probe's

// Returns the number of places that are smaller than both neighbours. Of equal neighbours, the first
// counts. The ends of the line have one neighbour.
std::int64_t count_minima(std::span<const double> values) {
  std::int64_t minima = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool falls = i == 0 || values[i] < values[i - 1];
    std::size_t next = i + 1;
    while (next < values.size() && values[next] == values[i]) {
      ++next;
    }
    minima += falls && (next == values.size() || values[next] > values[i]) ? 1 : 0;
  }
  return minima;
}

}  // namespace

bool is_rugged(Evaluator& evaluator, std::uint64_t seed, std::int64_t planned) {
  // The square of a quadratic residual, a polynomial of degree four, has at most two along a line.
  constexpr std::int64_t kMostSmooth = 2;
  const std::int64_t points = std::min(planned / kShare / kLines, kMostPoints);
  if (points < kFewestPoints) {
    return false;
  }
  const std::vector<DecisionVariable>& variables = evaluator.problem().variables;
  const SearchSpace space(adapt_variables(variables, {}));
  RandomStream random("optimizer/auto", seed);
  std::vector<std::vector<double>> batch;
  for (std::int64_t line = 0; line < kLines; ++line) {
    const std::vector<double> from = space.draw_between(space.lower(), space.upper(), random);
    const std::vector<double> to = space.draw_between(space.lower(), space.upper(), random);
    for (std::int64_t k = 0; k < points; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(points - 1);
      std::vector<double> coordinates(from.size());
      for (std::size_t i = 0; i < from.size(); ++i) {
        coordinates[i] = from[i] + share * (to[i] - from[i]);
      }
      std::vector<double> point = space.to_point(coordinates);
      for (std::size_t i = 0; i < point.size(); ++i) {
        point[i] = settle_value(variables[i], point[i]);
      }
      batch.push_back(std::move(point));
    }
  }
  const std::vector<Score> scores = evaluator.evaluate(batch);
  if (scores.size() < batch.size()) {
    return false;  // the run has stopped
  }
  std::vector<double> values;
  for (const Score& score : scores) {
    values.push_back(score.status == EvaluationStatus::ok
                         ? calc_scalar(evaluator.problem(), score.objectives)
                         : std::numeric_limits<double>::max());
  }
  const auto half = static_cast<std::ptrdiff_t>(values.size()) / kLines;
  return count_minima({values.begin(), values.begin() + half}) > kMostSmooth ||
         count_minima({values.begin() + half, values.end()}) > kMostSmooth;
}

}  // namespace armwright
