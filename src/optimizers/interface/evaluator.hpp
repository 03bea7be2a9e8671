// The only door from an optimizer to a problem. The run owns the implementation
// (study/run_evaluator.hpp); it counts the budget, clips to the bounds, supplies the training
// cases, journals everything and keeps the best feasible point. What an optimizer thinks is best is
// never asked for; it may recommend points.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// What an optimizer learns of a point. Always finite: a failed evaluation shows as the problem's
// penalty and its status.
struct Score {
  std::vector<double> objectives;
  std::vector<double>
      constraint_values;  // empty for a failed evaluation: take them as violated beyond measure
  std::vector<double> residuals;
  std::vector<double> jacobian;  // of the residuals, if asked for: a row a residual, a column a
                                 // decision variable, row after row; empty for a failed evaluation
  EvaluationStatus status = EvaluationStatus::ok;
  bool clipped =
      false;  // the point lay outside the bounds and was evaluated at the nearest point inside
};

// What an evaluation with exact derivatives is charged, in evaluations: one simulation for the
// values and one for every four variables or part of four.
constexpr std::int64_t calc_jacobian_charge(std::size_t variables) {
  return 1 + static_cast<std::int64_t>((variables + 3) / 4);
}

class Evaluator {
 public:
  virtual ~Evaluator() = default;
  virtual const ProblemDescription& problem() const = 0;

  // Evaluates the points in order. Fewer scores than points come back when the budget, the time or
  // the user's patience ends within the batch; from then on stopped() holds and every further batch
  // is answered with nothing.
  virtual std::vector<Score> evaluate(std::span<const std::vector<double>> points) = 0;
  // The same, with the exact derivatives of the residuals. Each costs calc_jacobian_charge()
  // evaluations of the budget, which ends where there is less left. Only of problems that
  // have a Jacobian, and through evaluators that pass this on: std::logic_error otherwise.
  virtual std::vector<Score> evaluate_with_jacobian(
      std::span<const std::vector<double>> /*points*/) {
    throw std::logic_error("this evaluator has no derivatives to give");
  }
  virtual bool stopped() const = 0;

  // How many more candidates the budget allows at the current number of training cases each.
  virtual std::int64_t remaining() const = 0;

  // Optimizers with generations call this before each of them, the first included: a `fresh`
  // schedule moves on to the next training cases here.
  virtual void begin_generation() = 0;
  // A point worth judging at the end beside the best evaluated ones: a distribution's mean, say.
  virtual void recommend(std::span<const double> x) = 0;
};

}  // namespace armwright
