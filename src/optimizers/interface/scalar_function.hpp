// An Evaluator as wrapped libraries want to see it: a function of coordinates (search_space.hpp)
// that they call when they like, and that ends the run by an exception.
#pragma once

#include <span>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

// Thrown through a wrapped library when the evaluator has stopped; the adapter catches it and
// returns. It carries nothing: the evaluator has kept everything.
struct EvaluatorStopped {};

// The weight of constraint violations for optimizers that know no constraints, and its option.
OptionSpec make_constraint_weight_option();

// f + weight * s * sum of max(0, g): an exact penalty for optimizers that know no constraints
// (Fletcher 1983, Penalty functions). f is calc_scalar() of the objectives, s the problem's
// violation_scale, so that a weight means the same in whatever unit f is; a failed evaluation is
// its penalty. Limits: its minimum is the constrained one only where weight * s exceeds the
// constraints' multipliers, and the higher it is, the sharper the bend that a search has to follow.
double calc_merit(const ProblemDescription& problem, const Score& score, double constraint_weight);

class ScalarFunction {
 public:
  explicit ScalarFunction(Evaluator& evaluator)
      : evaluator_(evaluator), space_(evaluator.problem().variables) {}

  const SearchSpace& space() const { return space_; }
  Evaluator& evaluator() const { return evaluator_; }

  // Throw EvaluatorStopped unless every point got its score.
  Score evaluate(std::span<const double> coordinates);
  Score evaluate_point(const std::vector<double>& point);  // a decision vector
  std::vector<Score> evaluate_batch(std::span<const std::vector<double>> coordinates);
  Score evaluate_with_jacobian(std::span<const double> coordinates);  // with respect to the point

 private:
  Evaluator& evaluator_;
  SearchSpace space_;
};

}  // namespace armwright
