// The interface through which an optimizer evaluates decision vectors. It is the optimizer's only
// access to a problem. A run implements it (study/run/run_evaluator.hpp): it counts the budget,
// moves points into the bounds, chooses the training cases, writes the journal and remembers the
// best feasible point. An optimizer returns no result; it may recommend points.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// The answer to one point. All numbers are finite: a failed evaluation has the problem's penalty as
// objectives, and its status.
struct Score {
  std::vector<double> objectives;
  // Empty for a failed evaluation: count every constraint as violated by an infinite amount.
  std::vector<double> constraint_values;
  std::vector<double> residuals;
  // Derivatives of the residuals, if the optimizer asked for them: one row per residual, one column
  // per decision variable, row-major. Empty for a failed evaluation.
  std::vector<double> jacobian;
  EvaluationStatus status = EvaluationStatus::ok;
  bool clipped = false;  // the point lay outside the bounds; the nearest point inside was evaluated
};

// Returns the price of one evaluation with exact derivatives, in evaluations: 1 for the values, and
// 1 for every four variables (rounded up).
constexpr std::int64_t calc_jacobian_charge(std::size_t variables) {
  return 1 + static_cast<std::int64_t>((variables + 3) / 4);
}

class Evaluator {
 public:
  virtual ~Evaluator() = default;
  virtual const ProblemDescription& problem() const = 0;

  // Evaluates the points in order and returns one score per point. Returns fewer scores if the
  // budget ends, the time limit is reached or the user stops the run within the batch. From then on
  // stopped() is true, and every further call returns an empty vector.
  virtual std::vector<Score> evaluate(std::span<const std::vector<double>> points) = 0;
  // Does the same with the exact derivatives of the residuals. Each point costs
  // calc_jacobian_charge() evaluations; the budget ends where less is left. Throws std::logic_error
  // if the problem has no Jacobian or this evaluator does not pass it on.
  virtual std::vector<Score> evaluate_with_jacobian(
      std::span<const std::vector<double>> /*points*/) {
    throw std::logic_error("this evaluator has no derivatives to give");
  }
  virtual bool stopped() const = 0;

  // Returns how many more candidates the budget allows, at the current number of training cases per
  // candidate.
  virtual std::int64_t remaining() const = 0;

  // An optimizer with generations calls this before each generation, also before the first. A
  // `fresh` schedule goes on to the next training cases here.
  virtual void begin_generation() = 0;
  // Recommends a point as a candidate for the winner, besides the best evaluated ones; for example
  // the mean of a distribution.
  virtual void recommend(std::span<const double> x) = 0;
};

}  // namespace armwright
