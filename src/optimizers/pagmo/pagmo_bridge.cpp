#include "optimizers/pagmo/pagmo_bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace armwright {
namespace {

// The value of each constraint of a failed evaluation. It is finite, because the methods add and
// square violations.
constexpr double kViolatedBeyondMeasure = 1e12;

}  // namespace

PagmoBridge::PagmoBridge(const PagmoMethod& method, const Options& options, Evaluator& evaluator)
    : method_(method),
      constraint_weight_(method.constraints ? 0 : options.get_number("constraint_weight")),
      function_(evaluator) {}

std::vector<std::vector<double>> PagmoBridge::evaluate(
    std::span<const std::vector<double>> coordinates) {
  try {
    for (const std::vector<double>& one : coordinates) {
      require_finite(one);
    }
    const std::vector<Score> scores = function_.evaluate_batch(coordinates);
    evaluation_count_ += static_cast<std::int64_t>(scores.size());
    std::vector<std::vector<double>> fitness;
    std::ranges::transform(scores, std::back_inserter(fitness),
                           [this](const Score& score) { return calc_fitness(score); });
    return fitness;
  } catch (...) {
    has_thrown_ = true;
    throw;
  }
}

void PagmoBridge::require_finite(std::span<const double> coordinates) const {
  if (!std::ranges::all_of(coordinates, [](double u) { return std::isfinite(u); })) {
    throw OptimizerFailure(
        fmt::format("optimizer '{}' asked for a point that is not finite", method_.row));
  }
}

std::vector<double> PagmoBridge::calc_fitness(const Score& score) const {
  if (method_.multi_objective) {
    const double violation = problem().violation_scale * calc_violation(score.constraint_values);
    std::vector<double> fitness = score.objectives;
    for (double& objective : fitness) {
      objective += constraint_weight_ * violation;
    }
    return fitness;
  }
  if (!method_.constraints) {
    return {calc_merit(problem(), score, constraint_weight_)};
  }
  std::vector<double> fitness = {calc_scalar(problem(), score.objectives)};
  if (score.constraint_values.size() == constraint_count()) {
    // Some methods compare the objective with the constraints.
    std::ranges::transform(score.constraint_values, std::back_inserter(fitness),
                           [this](double g) { return problem().violation_scale * g; });
  } else {
    fitness.resize(1 + constraint_count(), kViolatedBeyondMeasure);
  }
  return fitness;
}

std::vector<double> BridgedPagmoProblem::batch_fitness(const std::vector<double>& all) const {
  const auto dimension = static_cast<std::ptrdiff_t>(bridge->space().dimension());
  std::vector<std::vector<double>> points;
  for (auto from = all.begin(); from != all.end(); from += dimension) {
    points.emplace_back(from, from + dimension);
  }
  std::vector<double> joined;
  for (const std::vector<double>& one : bridge->evaluate(points)) {
    joined.insert(joined.end(), one.begin(), one.end());
  }
  return joined;
}

}  // namespace armwright
