#include "problems/interface/problem.hpp"

#include <algorithm>
#include <cassert>

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
