#include "problems/tracking_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace armwright {

double& get_parameter(ArmDesign& design, const DesignParameter& parameter) {
  JointDrive& joint = design.joints[parameter.joint];
  switch (parameter.kind) {
    case DesignParameter::Kind::effort_min:
      return joint.limits.min_n_m;
    case DesignParameter::Kind::effort_max:
      return joint.limits.max_n_m;
    case DesignParameter::Kind::gain:
      break;
  }
  return joint.gains[parameter.gain];
}

namespace {

DecisionVariable make_variable(const TrackingConfig& config, const DesignParameter& parameter) {
  const std::string& joint = config.robot.joints[parameter.joint].name;
  DecisionVariable variable;
  ArmDesign start = config.start;
  variable.start = get_parameter(start, parameter);
  switch (parameter.kind) {
    case DesignParameter::Kind::gain: {
      const GainSpec& gain = find_controller(config.start.controller).gains[parameter.gain];
      variable.name = joint + "." + gain.name;
      variable.unit = gain.unit;
      if (gain.range > 0) {
        const double lower = variable.start - gain.range;
        variable.lower = gain.any_sign ? lower : std::max(0.0, lower);
        variable.upper = variable.start + gain.range;
        return variable;
      }
      break;
    }
    case DesignParameter::Kind::effort_min:
      variable.name = joint + ".effort_min";
      variable.unit = "N m";
      break;
    case DesignParameter::Kind::effort_max:
      variable.name = joint + ".effort_max";
      variable.unit = "N m";
      break;
  }
  if (variable.start == 0) {
    throw Error(ErrorKind::usage,
                fmt::format("{} starts at 0, but a variable spans a factor around its start value; "
                            "give it another value in the design or leave it out of 'optimize'",
                            variable.name));
  }
  variable.scale = Scale::logarithmic;
  // The list form returns values; the two-argument form would return references to the temporaries.
  const auto [lower, upper] =
      std::minmax({variable.start / config.bounds_factor, variable.start * config.bounds_factor});
  variable.lower = lower;
  variable.upper = upper;
  if (!std::isnormal(lower) || !std::isnormal(upper)) {
    throw Error(ErrorKind::usage,
                fmt::format("{} starts at {} and would span {} to {}, which floating-point numbers "
                            "cannot hold; give it another value in the design or lower "
                            "bounds_factor",
                            variable.name, variable.start, lower, upper));
  }
  return variable;
}

}  // namespace

ProblemDescription make_tracking_description(const TrackingConfig& config) {
  ProblemDescription description;
  description.name = config.name;
  description.summary = config.summary;
  description.cost_unit = "simulated test case";
  for (const DesignParameter& parameter : config.parameters) {
    description.variables.push_back(make_variable(config, parameter));
  }
  const TrackingObjective& objective = config.objective;
  switch (objective.kind) {
    case TrackingObjective::Kind::error:
      description.objectives = {objective.logarithm ? Quantity{"ln(error / 1 m)", "1"}
                                                    : Quantity{"error", "m"}};
      break;
    case TrackingObjective::Kind::error_and_torque:
      description.objectives = {
          {objective.logarithm ? "ln(error and torque)" : "error and torque", "1"}};
      break;
    case TrackingObjective::Kind::error_vs_torque:
      description.objectives = {{"error", "m"}, {"total torque", "N m"}};
      description.objective_weights = {1 / objective.error_scale_m,
                                       objective.torque_weight / objective.torque_scale_n_m};
      break;
    case TrackingObjective::Kind::torque_with_error_limit:
      description.objectives = {objective.logarithm ? Quantity{"ln(total torque / 1 N m)", "1"}
                                                    : Quantity{"total torque", "N m"}};
      description.limits = {{{"error", "m"}, objective.error_limit_m}};
      description.violation_scale = objective.logarithm ? 1 : objective.torque_scale_n_m;
      break;
    case TrackingObjective::Kind::error_with_torque_limit:
      description.objectives = {objective.logarithm ? Quantity{"ln(error / 1 m)", "1"}
                                                    : Quantity{"error", "m"}};
      description.limits = {{{"total torque", "N m"}, objective.total_torque_limit_n_m}};
      description.violation_scale = objective.logarithm ? 1 : objective.error_scale_m;
      break;
  }
  for (const Limit& limit : description.limits) {
    description.constraints.push_back({limit.quantity.name + " / limit - 1", "1"});
  }
  description.has_residuals = description.limits.empty();
  description.metrics = {{"error", "m"},
                         {"total_torque", "N m"},
                         {"failures", "1"},
                         {"energy", "J"},
                         {"saturated_share", "1"}};
  for (const Joint& joint : config.robot.joints) {
    description.metrics.push_back({joint.name + ".peak_effort", "N m"});
    description.metrics.push_back({joint.name + ".rms_effort", "N m"});
  }
  return description;
}

}  // namespace armwright
