#include "problems/interface/problem.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/text.hpp"

namespace armwright {

const char* to_string(EvaluationStatus status) {
  switch (status) {
    case EvaluationStatus::ok:
      return "ok";
    case EvaluationStatus::diverged:
      return "diverged";
    case EvaluationStatus::unreachable:
      return "unreachable";
    case EvaluationStatus::timed_out:
      return "timed out";
    case EvaluationStatus::failed:
      return "failed";
    case EvaluationStatus::abandoned:
      return "abandoned";
  }
  assert(false && "an evaluation status without a name");
  return "failed";
}

const char* to_string(VariableType type) {
  switch (type) {
    case VariableType::real:
      return "real";
    case VariableType::integer:
      return "integer";
    case VariableType::category:
      return "category";
  }
  assert(false && "a type of variables without a name");
  return "real";
}

double settle_value(const DecisionVariable& variable, double value) {
  // Halves are rounded up. Adding 0 makes +0 of -0, so that equal values have equal bits.
  const double settled =
      variable.type == VariableType::real ? value : std::floor(value + 0.5) + 0.0;
  return std::clamp(settled, variable.lower, variable.upper);
}

std::string format_value(const DecisionVariable& variable, double value) {
  if (variable.type != VariableType::category) {
    return format_exact(value);
  }
  const auto place = static_cast<std::size_t>(settle_value(variable, value));
  return variable.choices.at(place);
}

std::vector<double> list_starts(std::span<const DecisionVariable> variables) {
  std::vector<double> starts;
  for (const DecisionVariable& variable : variables) {
    starts.push_back(variable.start);
  }
  return starts;
}

bool has_discrete(std::span<const DecisionVariable> variables) {
  return std::ranges::any_of(variables, [](const DecisionVariable& variable) {
    return variable.type != VariableType::real;
  });
}

double calc_scalar(std::span<const double> weights, std::span<const double> objectives) {
  if (weights.empty()) {
    return objectives.front();
  }
  double sum = 0;
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    sum += weights[i] * objectives[i];
  }
  return sum;
}

double calc_scalar(const ProblemDescription& problem, std::span<const double> objectives) {
  return calc_scalar(problem.objective_weights, objectives);
}

Quantity get_scalar_quantity(std::span<const Quantity> objectives) {
  return objectives.size() == 1 ? objectives.front() : Quantity{"weighted sum", "1"};
}

bool is_feasible(const Evaluation& evaluation) {
  return !evaluation.objectives.empty() && evaluation.status != EvaluationStatus::abandoned &&
         std::all_of(evaluation.constraint_values.begin(), evaluation.constraint_values.end(),
                     [](double g) { return g <= 0; });
}

double calc_violation(std::span<const double> constraint_values) {
  double violation = 0;
  for (const double g : constraint_values) {
    violation += std::max(0.0, g);
  }
  return violation;
}

Evaluation Problem::evaluate(std::span<const double> x, const CaseBlock& block,
                             bool jacobian) const {
  std::vector<CaseJob> jobs;
  jobs.reserve(block.numbers.size());
  for (const std::uint64_t number : block.numbers) {
    jobs.push_back(
        {.x = x, .block = &block, .number = number, .residuals = true, .jacobian = jacobian});
  }
  return aggregate(x, simulate(jobs));
}

}  // namespace armwright
