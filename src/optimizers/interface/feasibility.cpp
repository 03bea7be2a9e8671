#include "optimizers/interface/feasibility.hpp"

#include <algorithm>
#include <cmath>

namespace armwright {
namespace {

// The violation of a failed evaluation: finite, and larger than that of any design.
constexpr double kFailedViolation = 1e12;

}  // namespace

Fitness calc_fitness(const ProblemDescription& problem, const Score& score) {
  const bool is_failed = score.constraint_values.size() < problem.constraints.size();
  return {.violation = is_failed ? std::numeric_limits<double>::infinity()
                                 : calc_violation(score.constraint_values),
          .objective = calc_scalar(problem, score.objectives)};
}

bool is_fitter(const Fitness& a, const Fitness& b) {
  return a.violation != b.violation ? a.violation < b.violation : a.objective < b.objective;
}

std::vector<double> FeasibilityOrder::rate(std::span<const Score> scores) {
  std::vector<Fitness> all;
  for (const Score& score : scores) {
    all.push_back(calc_fitness(problem_, score));
    if (std::isfinite(all.back().violation)) {
      largest_objective_ = std::max(largest_objective_, all.back().objective);
    }
  }
  // No design has had a number so far, so any level is possible.
  const double level = std::isfinite(largest_objective_) ? largest_objective_ : 0;
  std::vector<double> values;
  for (const Fitness& one : all) {
    values.push_back(one.violation > 0 ? level + problem_.violation_scale *
                                                     std::min(one.violation, kFailedViolation)
                                       : one.objective);
  }
  return values;
}

}  // namespace armwright
