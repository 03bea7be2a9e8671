#include "optimizers/interface/treated_problem.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace armwright {
namespace {

bool can_treat(const Capabilities& capabilities, VariableType type) {
  return type == VariableType::real ||
         (type == VariableType::integer ? capabilities.integer : capabilities.categorical);
}

}  // namespace

std::vector<DecisionVariable> adapt_variables(std::span<const DecisionVariable> variables,
                                              const Capabilities& capabilities) {
  constexpr double kHalfStep = 0.5;
  std::vector<DecisionVariable> adapted(variables.begin(), variables.end());
  for (DecisionVariable& variable : adapted) {
    if (variable.type == VariableType::category && !capabilities.categorical) {
      variable.type = VariableType::integer;
      variable.choices.clear();
    }
    if (variable.type == VariableType::integer && !capabilities.integer) {
      variable.type = VariableType::real;
      variable.lower -= kHalfStep;
      variable.upper += kHalfStep;
    }
  }
  return adapted;
}

TreatedProblem::TreatedProblem(const ProblemDescription& problem, const Capabilities& capabilities)
    : problem_(&problem), has_discrete_(has_discrete(problem.variables)) {
  if (!std::ranges::all_of(problem.variables, [&](const DecisionVariable& variable) {
        return can_treat(capabilities, variable.type);
      })) {
    adapted_ = problem;
    adapted_->variables = adapt_variables(problem.variables, capabilities);
  }
}

TreatedProblem::Point TreatedProblem::settle(std::span<const double> point) const {
  const std::vector<DecisionVariable>& given = description().variables;
  assert(point.size() == given.size());
  Point settled;
  settled.x.resize(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) {
    // For NaN there is no nearest point inside the bounds, so the start value replaces it.
    const double inside = std::isnan(point[i])
                              ? given[i].start
                              : std::clamp(point[i], given[i].lower, given[i].upper);
    settled.clipped |= !(inside == point[i]);
    settled.x[i] = inside;
  }
  if (has_discrete_) {
    settled.proposed = settled.x;
    for (std::size_t i = 0; i < point.size(); ++i) {
      settled.x[i] = settle_value(problem_->variables[i], settled.x[i]);
    }
    if (settled.proposed == settled.x) {
      settled.proposed.clear();
    }
  }
  return settled;
}

}  // namespace armwright
