#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "optimizers/interface/capability_table.hpp"
#include "parts.hpp"

namespace armwright::python {
namespace {

using nlohmann::json;

json describe_quantities(std::span<const Quantity> quantities) {
  json list = json::array();
  for (const Quantity& quantity : quantities) {
    list.push_back({{"name", quantity.name}, {"unit", quantity.unit}});
  }
  return list;
}

json describe_limits(std::span<const Limit> limits) {
  json list = json::array();
  for (const Limit& limit : limits) {
    list.push_back(
        {{"name", limit.quantity.name}, {"unit", limit.quantity.unit}, {"value", limit.value}});
  }
  return list;
}

json describe_option(const OptionSpec& option) {
  json one = {
      {"name", option.name},
      {"default", std::visit([](const auto& value) { return json(value); }, option.fallback)},
      {"description", option.description},
      {"lower", nullptr},
      {"upper", nullptr},
      {"choices", option.choices}};
  const bool is_number = std::holds_alternative<std::int64_t>(option.fallback) ||
                         std::holds_alternative<double>(option.fallback);
  if (is_number) {
    one["lower"] = option.lower;
    one["upper"] = option.upper;
  }
  return one;
}

template <class Value>
json or_null(const std::optional<Value>& value) {
  return value ? json(*value) : json();
}

}  // namespace

json describe(const ProblemDescription& problem) {
  json variables = json::array();
  for (const DecisionVariable& variable : problem.variables) {
    variables.push_back({{"name", variable.name},
                         {"unit", variable.unit},
                         {"lower", variable.lower},
                         {"upper", variable.upper},
                         {"start", variable.start},
                         {"scale", variable.scale == Scale::linear ? "linear" : "logarithmic"}});
    if (variable.type != VariableType::real) {
      variables.back()["type"] = to_string(variable.type);
      variables.back()["choices"] = variable.choices;
    }
  }
  json requirements = json::array();
  for (const RequiredMetric& required : problem.requirements) {
    requirements.push_back({{"name", required.limit.quantity.name},
                            {"unit", required.limit.quantity.unit},
                            {"limit", required.limit.value},
                            {"use", required.is_constraint ? "constraint" : "report"}});
  }
  return {{"name", problem.name},
          {"summary", problem.summary},
          {"variables", variables},
          {"objectives", describe_quantities(problem.objectives)},
          {"objective_weights", problem.objective_weights},
          {"constraints", describe_quantities(problem.constraints)},
          {"limits", describe_limits(problem.limits)},
          {"violation_scale", problem.violation_scale},
          {"metrics", describe_quantities(problem.metrics)},
          {"requirements", requirements},
          {"cost_unit", problem.cost_unit},
          {"known_optimum", problem.known_optimum},
          {"has_residuals", problem.has_residuals},
          {"residuals_advice", problem.residuals_advice},
          {"has_jacobian", problem.has_jacobian},
          {"jacobian_advice", problem.jacobian_advice}};
}

json describe(const LoadedProblem& problem) {
  json all = describe(problem.problem->description());
  all["name"] = problem.name;
  all["title"] = problem.title;
  all["is_arm"] = problem.tracking() != nullptr;
  all["schedule"] = to_text(problem.schedule);
  all["fixed_cases"] = problem.fixed_cases;
  all["racing"] = to_text(problem.racing);
  all["optimizer"] = problem.optimizer;
  all["budget"] = problem.budget;
  all["sets"] = {{"training", problem.sets.training},
                 {"validation", problem.sets.validation},
                 {"test", problem.sets.test},
                 {"validation_cases", problem.sets.validation_cases},
                 {"test_cases", problem.sets.test_cases}};
  all["published"] = {{"error_m", or_null(problem.published.error_m)},
                      {"total_torque_n_m", or_null(problem.published.total_torque_n_m)},
                      {"design", problem.published.design},
                      {"where", problem.published.where}};
  all["configuration"] = json::parse(problem.resolved_json);
  all["inputs"] = problem.input_hashes;
  return all;
}

json describe(const OptimizerRow& row) {
  json capabilities = json::array();
  for (const CapabilityRow& one : kCapabilityTable) {
    if (row.capabilities.*one.member) {
      capabilities.push_back(one.name);
    }
  }
  json options = json::array();
  std::ranges::transform(row.options, std::back_inserter(options), describe_option);
  return {{"name", row.name},
          {"summary", row.summary},
          {"source", row.source},
          {"capabilities", capabilities},
          {"requirements",
           {{"objectives", row.requirements.objectives},
            {"variables", row.requirements.variables},
            {"residuals", row.requirements.residuals}}},
          {"options", options},
          {"library", row.backend},
          {"isolated", row.isolated},
          {"unavailable", row.unavailable}};
}

}  // namespace armwright::python
