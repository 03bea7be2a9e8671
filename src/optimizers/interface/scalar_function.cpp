#include "optimizers/interface/scalar_function.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"

namespace armwright {

OptionSpec make_constraint_weight_option() {
  return {.name = "constraint_weight",
          .description =
              "the objective grows by this times the violation of the constraints, which this "
              "optimizer does not know, in units of the objective's scale where the problem names "
              "one; without constraints no influence",
          .fallback = 1000.0,
          .lower = 0,
          .upper = 1e12};
}

void require_jacobian(const ProblemDescription& problem, std::string_view optimizer,
                      std::string_view setting, std::string_view instead) {
  if (!problem.has_jacobian) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}': option {}, but problem {} offers no exact "
                            "derivatives: {}; or use {}",
                            optimizer, setting, problem.name,
                            problem.jacobian_advice.empty() ? "only arms on an engine that "
                                                              "computes them do"
                                                            : problem.jacobian_advice,
                            instead));
  }
}

double calc_merit(const ProblemDescription& problem, const Score& score, double constraint_weight) {
  return calc_scalar(problem, score.objectives) +
         constraint_weight * problem.violation_scale * calc_violation(score.constraint_values);
}

std::vector<double> ScalarFunction::to_point(std::span<const double> coordinates) const {
  std::vector<double> point = space_.to_point(coordinates);
  const std::vector<DecisionVariable>& variables = evaluator_.problem().variables;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (variables[i].type != VariableType::real) {
      point[i] = settle_value(variables[i], point[i]);
    }
  }
  return point;
}

Score ScalarFunction::evaluate(std::span<const double> coordinates) {
  return evaluate_point(to_point(coordinates));
}

Score ScalarFunction::evaluate_point(const std::vector<double>& point) {
  std::vector<Score> scores = evaluator_.evaluate({&point, 1});
  if (scores.empty()) {
    throw EvaluatorStopped{};
  }
  return std::move(scores.front());
}

Score ScalarFunction::evaluate_with_jacobian(std::span<const double> coordinates) {
  const std::vector<double> point = to_point(coordinates);
  std::vector<Score> scores = evaluator_.evaluate_with_jacobian({&point, 1});
  if (scores.empty()) {
    throw EvaluatorStopped{};
  }
  return std::move(scores.front());
}

std::vector<Score> ScalarFunction::evaluate_batch(
    std::span<const std::vector<double>> coordinates) {
  std::vector<std::vector<double>> points;
  points.reserve(coordinates.size());
  std::ranges::transform(coordinates, std::back_inserter(points),
                         [this](const auto& one) { return to_point(one); });
  std::vector<Score> scores = evaluator_.evaluate(points);
  if (scores.size() < points.size()) {
    throw EvaluatorStopped{};
  }
  return scores;
}

}  // namespace armwright
