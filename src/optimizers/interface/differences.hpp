// Derivatives for optimizers that need them: of a vector of values (residuals, or one merit) with
// respect to the coordinates of search_space.hpp. They come from finite differences, or from the
// problem where it has exact ones.
//
// Finite differences. Every shifted point is an ordinary evaluation. All shifted points of one
// place form one batch and count towards the budget.
//
//   forward: (v(u + h e_i) - v(u)) / h             error proportional to h,    n points
//   central: (v(u + h e_i) - v(u - h e_i)) / (2 h)  error proportional to h^2, 2n points
//
// h is a share of the box. A shift that would leave the box goes to the other side. If the
// evaluation of one side is missing or failed, the base point replaces it. If no side is left, the
// derivative is 0.
//
// Exact derivatives: the Jacobian of the residuals (Evaluator::evaluate_with_jacobian) and the
// chain rule. A place whose values are known is evaluated again for its derivatives.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "optimizers/interface/scalar_function.hpp"

namespace armwright {

struct DifferenceSettings {
  bool central = false;
  double step = 0.005;  // share of the box, at most 0.5
};
// Returns the option `differences`: "forward" or "central".
OptionSpec make_differences_option(const char* fallback);
// Reads that option and the option `step`.
DifferenceSettings read_differences(const Options& options);

// Returns the derivative of each value with respect to the residual with the same index, the only
// residual that it depends on. Empty if the evaluation failed. Exact derivatives need this
// function.
using ResidualSlopes = std::function<std::vector<double>(const Score&)>;

// A function with derivatives on an Evaluator. It remembers every place, so that no place is
// evaluated twice.
class DifferencedFunction {
 public:
  // Returns the values to differentiate. Empty if the evaluation failed.
  using ValuesOf = std::function<std::vector<double>(const Score&)>;

  // The values and derivatives at one place of the box.
  struct Place {
    std::vector<double> values;                    // empty: failed
    std::vector<std::vector<double>> derivatives;  // one column per variable; empty: not computed
  };

  DifferencedFunction(Evaluator& evaluator, ValuesOf values_of, const DifferenceSettings& settings)
      : function_(evaluator), values_of_(std::move(values_of)), settings_(settings) {}
  // Makes a function with exact derivatives.
  DifferencedFunction(Evaluator& evaluator, ValuesOf values_of, ResidualSlopes residual_slopes)
      : function_(evaluator),
        values_of_(std::move(values_of)),
        residual_slopes_(std::move(residual_slopes)) {}

  bool is_exact() const { return residual_slopes_ != nullptr; }
  const SearchSpace& space() const { return function_.space(); }

  // Returns the values at a place and, on request, the derivatives. The derivatives of a failed
  // place stay empty. The reference is valid until the next call. Throws EvaluatorStopped and every
  // exception of the evaluator.
  const Place& evaluate_place(const std::vector<double>& coordinates, bool with_derivatives);

  // The evaluated point with the smallest objective (calc_scalar()), including shifted points.
  // Empty until one evaluation did not fail.
  struct Best {
    std::vector<double> coordinates;
    Score score;
  };
  const std::optional<Best>& best() const { return best_; }

  // Adds a point that another function has evaluated, so that it is not evaluated again.
  void learn(const Best& known) {
    places_[known.coordinates].values = values_of_(known.score);
    best_ = known;
  }

 private:
  std::vector<Score> evaluate(const std::vector<std::vector<double>>& batch);
  void remember_best(const std::vector<double>& coordinates, const Score& score);
  const Place& evaluate_exactly(const std::vector<double>& coordinates);

  ScalarFunction function_;
  ValuesOf values_of_;
  ResidualSlopes residual_slopes_;  // null: finite differences
  DifferenceSettings settings_;
  std::map<std::vector<double>, Place> places_;
  std::optional<Best> best_;
};

}  // namespace armwright
