// An Evaluator in the form that wrapped libraries need: a function of coordinates
// (search_space.hpp) that a library calls at any time, and that ends the run by an exception.
// Discrete variables that the optimizer gets are real in these coordinates
// (treated_problem.hpp), and the points that are evaluated are rounded.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "optimizers/interface/search_space.hpp"
#include "optimizers/interface/treated_problem.hpp"

namespace armwright {

// Thrown through a wrapped library when the evaluator has stopped. The adapter catches it and
// returns. It has no content, because the evaluator keeps all results.
struct EvaluatorStopped {};

// Returns the option for the weight of constraint violations, for optimizers that do not handle
// constraints.
OptionSpec make_constraint_weight_option();

// Throws Error{usage} if the problem offers no exact derivatives of its residuals. `setting` says how
// the user asked for them ("jacobian is true"), and `instead` how not to ask ("jacobian=false").
void require_jacobian(const ProblemDescription& problem, std::string_view optimizer,
                      std::string_view setting, std::string_view instead);

// Returns an exact penalty function for optimizers that do not handle constraints (Fletcher 1983,
// Penalty functions):
//   merit = f + weight * s * sum of max(0, g)
// f is calc_scalar() of the objectives. s is the problem's violation_scale, so that a weight means
// the same in every unit of f. A failed evaluation has its penalty as f. Limits: the minimum of the
// merit is the constrained minimum only if weight * s exceeds the constraints' multipliers. A
// higher weight makes the bend at a constraint sharper and the search harder.
double calc_merit(const ProblemDescription& problem, const Score& score, double constraint_weight);

// Returns a seed for libraries whose random numbers begin at one of 2^32 places. A seed below 2^32
// stays as it is; of a larger one both halves count.
inline std::uint32_t fold_seed(std::uint64_t seed) {
  return static_cast<std::uint32_t>(seed ^ (seed >> 32));
}

class ScalarFunction {
 public:
  explicit ScalarFunction(Evaluator& evaluator)
      : evaluator_(evaluator), space_(adapt_variables(evaluator.problem().variables, {})) {}

  const SearchSpace& space() const { return space_; }
  Evaluator& evaluator() const { return evaluator_; }

  // Evaluate points. Throw EvaluatorStopped unless every point has its score.
  Score evaluate(std::span<const double> coordinates);
  Score evaluate_point(const std::vector<double>& point);  // a decision vector
  std::vector<Score> evaluate_batch(std::span<const std::vector<double>> coordinates);
  Score evaluate_with_jacobian(std::span<const double> coordinates);  // with respect to the point

 private:
  std::vector<double> to_point(std::span<const double> coordinates) const;

  Evaluator& evaluator_;
  SearchSpace space_;
};

}  // namespace armwright
