// Derivatives for optimizers that need some: of a vector of values (residuals, or one merit) with
// respect to the coordinates of search_space.hpp. By differences, or exact where the problem offers
// that.
//
// Differences: every shifted point is an
// evaluation like any other: all those of one place are asked for as one batch and counted.
//
//   forward: (v(u + h e_i) - v(u)) / h         the error falls with h, n points
//   central: (v(u + h e_i) - v(u - h e_i)) / 2h  the error falls with h^2, 2n points
//
// h is a share of the box. A shift that would leave the box goes the other way; where a side is
// missing, or its evaluation failed, the base point stands for it, and where nothing is left the
// derivative is 0.
//
// Exact: the Jacobian of the residuals (Evaluator::evaluate_with_jacobian) and the chain rule. A
// place whose values are known already is evaluated again for it.
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

// What makes exact derivatives possible: those of each value with respect to the residual of the
// same number, on which alone it depends. Empty where the evaluation failed.
using ResidualSlopes = std::function<std::vector<double>(const Score&)>;

class DifferencedFunction {
 public:
  // What is differentiated; empty where the evaluation failed.
  using ValuesOf = std::function<std::vector<double>(const Score&)>;

  // A place in the box and what is known of it. Places are kept, so that none is asked for twice.
  struct Place {
    std::vector<double> values;                    // empty: failed
    std::vector<std::vector<double>> derivatives;  // one column a variable; empty: not asked for
  };

  DifferencedFunction(Evaluator& evaluator, ValuesOf values_of, const DifferenceSettings& settings)
      : function_(evaluator), values_of_(std::move(values_of)), settings_(settings) {}
  // With exact derivatives.
  DifferencedFunction(Evaluator& evaluator, ValuesOf values_of, ResidualSlopes residual_slopes)
      : function_(evaluator),
        values_of_(std::move(values_of)),
        residual_slopes_(std::move(residual_slopes)) {}

  bool is_exact() const { return residual_slopes_ != nullptr; }
  const SearchSpace& space() const { return function_.space(); }

  // Throw EvaluatorStopped, and whatever the evaluator throws. The derivatives of a failed place
  // stay empty. Valid until the next call.
  const Place& look_at(const std::vector<double>& coordinates, bool with_derivatives);

  // The evaluated point with the smallest objective (calc_scalar()), shifted ones included; none
  // before the first that did not fail.
  struct Best {
    std::vector<double> coordinates;
    Score score;
  };
  const std::optional<Best>& best() const { return best_; }

  // What is known already, which is not asked for again: another function's best.
  void learn(const Best& known) {
    places_[known.coordinates].values = values_of_(known.score);
    best_ = known;
  }

 private:
  struct Shift {
    std::optional<std::size_t> above;  // places in the batch
    std::optional<std::size_t> below;
  };

  Shift add_shifts(const std::vector<double>& base, std::size_t variable,
                   std::vector<std::vector<double>>& batch) const;

  std::vector<Score> evaluate(const std::vector<std::vector<double>>& batch);
  void remember_best(const std::vector<double>& coordinates, const Score& score);
  const Place& look_exactly(const std::vector<double>& coordinates);

  ScalarFunction function_;
  ValuesOf values_of_;
  ResidualSlopes residual_slopes_;  // of exact derivatives
  DifferenceSettings settings_;
  std::map<std::vector<double>, Place> places_;
  std::optional<Best> best_;
};

}  // namespace armwright
