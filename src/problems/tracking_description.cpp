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

bool has_duration_metric(const TrackingConfig& config) {
  return config.objective.duration_weight > 0;
}

double calc_case_duration_s(const TrackingTask& task, const WorkspaceSphere& sphere) {
  double duration_s = 0;
  for (int k = 1; k <= sphere.points; ++k) {
    duration_s +=
        std::max(sphere.calc_move_m(k), task.distance_limit_m) / task.speed_m_per_s + task.rest_s;
  }
  return duration_s;
}

namespace {

DecisionVariable make_variable(const TrackingConfig& config, const DesignParameter& parameter) {
  const std::string& joint = config.robot.joints[parameter.joint].name;
  DecisionVariable variable;
  switch (parameter.kind) {
    case DesignParameter::Kind::gain: {
      const GainSpec& gain = find_controller(config.start.controller).gains[parameter.gain];
      variable.name = joint + "." + gain.name;
      variable.unit = gain.unit;
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
  ArmDesign start = config.start;
  variable.start = get_parameter(start, parameter);
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
  description.objectives = describe_objectives(objective);
  switch (objective.kind) {
    case TrackingObjective::Kind::error:
    case TrackingObjective::Kind::error_and_torque:
      break;
    case TrackingObjective::Kind::error_vs_torque:
      description.objective_weights = {1 / objective.error_scale_m,
                                       objective.torque_weight / objective.torque_scale_n_m};
      break;
    case TrackingObjective::Kind::torque_with_error_limit:
      description.limits = {{{describe_error(objective), "m"}, objective.error_limit_m}};
      description.violation_scale = objective.logarithm ? 1 : objective.torque_scale_n_m;
      break;
    case TrackingObjective::Kind::error_with_torque_limit:
      description.limits = {{{"total torque", "N m"}, objective.total_torque_limit_n_m}};
      description.violation_scale = objective.logarithm ? 1 : objective.error_scale_m;
      break;
  }
  for (const Limit& limit : description.limits) {
    description.constraints.push_back({limit.quantity.name + " / limit - 1", "1"});
  }
  description.has_residuals = objective.has_residuals();
  if (!description.has_residuals && description.limits.empty()) {
    description.residuals_advice =
        "only objective.statistic = \"mean\" is such a sum; choose it or another optimizer";
  }
  description.metrics = {{"error", "m"},
                         {"total_torque", "N m"},
                         {"failures", "1"},
                         {"energy", "J"},
                         {"saturated_share", "1"}};
  if (has_duration_metric(config)) {
    description.metrics.push_back({"duration", "s"});
  }
  for (const Joint& joint : config.robot.joints) {
    description.metrics.push_back({joint.name + ".peak_effort", "N m"});
    description.metrics.push_back({joint.name + ".rms_effort", "N m"});
  }
  return description;
}

}  // namespace armwright
