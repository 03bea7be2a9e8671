#include "problems/tracking/tracking_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {

const std::vector<std::string>& failure_rule_names() {
  static const std::vector<std::string> names = {"ordered", "thesis"};
  return names;
}

double& get_parameter(ArmDesign& design, const DesignParameter& parameter) {
  JointDrive& joint = design.joints[parameter.joint];
  switch (parameter.kind) {
    case DesignParameter::Kind::effort_min:
      return joint.limits.min;
    case DesignParameter::Kind::effort_max:
      return joint.limits.max;
    case DesignParameter::Kind::length_scale:
      return joint.length_scale;
    case DesignParameter::Kind::section_scale:
      return joint.section_scale;
    case DesignParameter::Kind::tube_diameter:
      return joint.tube.diameter_m;
    case DesignParameter::Kind::tube_wall:
      return joint.tube.wall_m;
    case DesignParameter::Kind::speed:
      return design.speed_m_per_s.value();
    case DesignParameter::Kind::gain:
      break;
  }
  return joint.gains[parameter.gain];
}

bool is_effort(const DesignParameter& parameter) {
  return parameter.kind == DesignParameter::Kind::effort_min ||
         parameter.kind == DesignParameter::Kind::effort_max;
}

double get_bounds_factor(const TrackingConfig& config, const DesignParameter& parameter) {
  switch (parameter.kind) {
    case DesignParameter::Kind::length_scale:
      return config.length_bounds_factor;
    case DesignParameter::Kind::section_scale:
      return config.section_bounds_factor;
    case DesignParameter::Kind::speed:
      return config.speed_bounds_factor;
    case DesignParameter::Kind::gain:
    case DesignParameter::Kind::effort_min:
    case DesignParameter::Kind::effort_max:
    case DesignParameter::Kind::tube_diameter:
    case DesignParameter::Kind::tube_wall:
      break;
  }
  return config.bounds_factor;
}

bool changes_links(const TrackingConfig& config) {
  return std::ranges::any_of(config.parameters, [](const DesignParameter& parameter) {
    return parameter.kind == DesignParameter::Kind::length_scale ||
           parameter.kind == DesignParameter::Kind::section_scale ||
           parameter.kind == DesignParameter::Kind::tube_diameter ||
           parameter.kind == DesignParameter::Kind::tube_wall;
  });
}

bool changes_speed(const TrackingConfig& config) {
  return std::ranges::any_of(config.parameters, [](const DesignParameter& parameter) {
    return parameter.kind == DesignParameter::Kind::speed;
  });
}

bool has_mass_metric(const TrackingConfig& config) {
  return config.torque_per_mass_n_m_per_kg > 0 || changes_links(config);
}

bool has_deflection_metric(const TrackingConfig& config) {
  return !config.tubes.tubes.empty();
}

bool has_duration_metric(const TrackingConfig& config) {
  return config.objective.duration_weight > 0 || changes_speed(config);
}

std::vector<double> list_moves_m(const TrackingConfig& config) {
  std::vector<double> moves_m;
  if (config.never_rests()) {
    return moves_m;
  }
  if (config.path) {
    const auto& points_m = config.path->points_m;
    for (std::size_t k = 1; k < points_m.size(); ++k) {
      moves_m.push_back((points_m[k] - points_m[k - 1]).norm());
    }
    return moves_m;
  }
  for (int k = 1; k <= config.workspace.points; ++k) {
    moves_m.push_back(config.workspace.calc_move_m(k));
  }
  return moves_m;
}

double calc_case_duration_s(const TrackingConfig& config, const TrackingTask& task) {
  double duration_s = 0;
  if (config.never_rests()) {
    return static_cast<double>(config.path->points_m.size() - 1) * task.control_period_s;
  }
  for (const double move_m : list_moves_m(config)) {
    duration_s += std::max(move_m, task.distance_limit_m) / task.speed_m_per_s + task.rest_s;
  }
  return duration_s;
}

namespace {

// Returns how the user moves the bounds of a parameter that spans a factor around its start.
std::string describe_widening(const DesignParameter& parameter, double factor) {
  constexpr double kMore = 10, kMoreOfSize = 2;  // sizes and the speed span less than gains
  const auto describe = [factor](std::string_view key, double more) {
    return fmt::format("--set variables.{}={} (it is {})", key, format_exact(more * factor),
                       format_exact(factor));
  };
  switch (parameter.kind) {
    case DesignParameter::Kind::length_scale:
      return describe("length_bounds_factor", kMoreOfSize);
    case DesignParameter::Kind::section_scale:
      return describe("section_bounds_factor", kMoreOfSize);
    case DesignParameter::Kind::speed:
      return describe("speed_bounds_factor", kMoreOfSize);
    default:
      return describe("bounds_factor", kMore);
  }
}

DecisionVariable make_variable(const TrackingConfig& config, const DesignParameter& parameter) {
  const std::string& joint = config.robot.joints[parameter.joint].name;
  const JointKind kind = config.robot.joints[parameter.joint].kind;
  DecisionVariable variable;
  ArmDesign start = config.start;
  variable.start = get_parameter(start, parameter);
  switch (parameter.kind) {
    case DesignParameter::Kind::gain: {
      const controllers::Gain& gain =
          find_controller(config.start.controller).gains[parameter.gain];
      variable.name = joint + "." + gain.name;
      variable.unit = get_joint_unit(gain.unit, kind);
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
      variable.unit = get_joint_unit("N m", kind);
      break;
    case DesignParameter::Kind::effort_max:
      variable.name = joint + ".effort_max";
      variable.unit = get_joint_unit("N m", kind);
      break;
    case DesignParameter::Kind::length_scale:
      variable.name = joint + ".length_scale";
      variable.unit = "1";
      break;
    case DesignParameter::Kind::section_scale:
      variable.name = joint + ".section_scale";
      variable.unit = "1";
      break;
    case DesignParameter::Kind::tube_diameter:
    case DesignParameter::Kind::tube_wall: {
      const bool is_wall = parameter.kind == DesignParameter::Kind::tube_wall;
      const VariableBounds& bounds =
          (is_wall ? config.tubes.wall_m : config.tubes.diameter_m).value();
      variable.name = joint + (is_wall ? ".tube_wall" : ".tube_diameter");
      variable.unit = "m";
      variable.lower = bounds.lower;
      variable.upper = bounds.upper;
      variable.lower_widening = variable.upper_widening =
          fmt::format("the key tubes.{}", is_wall ? "wall_bounds_m" : "diameter_bounds_m");
      if (variable.start < bounds.lower || variable.start > bounds.upper) {
        throw Error(ErrorKind::usage,
                    fmt::format("{} starts at {:g} m, outside of tubes.{}, {:g} to {:g} m; give it "
                                "another value in the design or change the bounds",
                                variable.name, variable.start,
                                is_wall ? "wall_bounds_m" : "diameter_bounds_m", bounds.lower,
                                bounds.upper));
      }
      return variable;
    }
    case DesignParameter::Kind::speed:
      variable.name = "task.speed";
      variable.unit = "m/s";
      break;
  }
  if (variable.start == 0) {
    throw Error(ErrorKind::usage,
                fmt::format("{} starts at 0, but a variable spans a factor around its start value; "
                            "give it another value in the design or leave it out of 'optimize'",
                            variable.name));
  }
  variable.scale = Scale::logarithmic;
  // With an initializer list, std::minmax returns values. With two arguments it would return
  // references to temporaries.
  const double factor = get_bounds_factor(config, parameter);
  const auto [lower, upper] = std::minmax({variable.start / factor, variable.start * factor});
  variable.lower = lower;
  variable.upper = upper;
  variable.lower_widening = variable.upper_widening = describe_widening(parameter, factor);
  if (config.within_effort_limits && is_effort(parameter)) {
    const double limit = config.robot.joints[parameter.joint].effort_limit;
    if (std::abs(variable.start) > limit) {
      throw Error(ErrorKind::usage,
                  fmt::format("{} starts at {}, beyond the joint's effort limit of {} in the URDF; "
                              "give it another value in the design or set "
                              "variables.within_effort_limits to false",
                              variable.name, variable.start, limit));
    }
    constexpr const char* kOfRobot =
        "--set variables.within_effort_limits=false, beyond the "
        "effort limit of the robot's file";
    if (variable.lower < -limit) {
      variable.lower = -limit;
      variable.lower_widening = kOfRobot;
    }
    if (variable.upper > limit) {
      variable.upper = limit;
      variable.upper_widening = kOfRobot;
    }
  }
  if (!std::isnormal(lower) || !std::isnormal(upper)) {
    throw Error(ErrorKind::usage,
                fmt::format("{} starts at {} and would span {} to {} (the start / and x "
                            "variables.bounds_factor), which floating-point numbers cannot hold; "
                            "give it another value in the design or lower the factor",
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
  description.failure_error = kFailureError_m;
  for (const DesignParameter& parameter : config.parameters) {
    description.variables.push_back(make_variable(config, parameter));
  }
  const TrackingObjective& objective = config.objective;
  std::vector<Quantity> required;
  for (const Requirement& requirement : config.requirements) {
    required.push_back(describe_requirement(requirement, config.robot));
  }
  description.objectives = describe_objectives(objective, required);
  description.resolution = calc_resolution(objective);
  switch (objective.kind) {
    case TrackingObjective::Kind::error:
    case TrackingObjective::Kind::error_and_torque:
      break;
    case TrackingObjective::Kind::front:
      for (const WeightedQuantity& term : objective.front) {
        description.objective_weights.push_back(term.weight / term.scale);
      }
      break;
    case TrackingObjective::Kind::torque_with_error_limit:
      description.violation_scale = objective.logarithm ? 1 : objective.torque_scale_n_m;
      break;
    case TrackingObjective::Kind::error_with_torque_limit:
      description.violation_scale = objective.logarithm ? 1 : objective.error_scale_m;
      break;
  }
  if (objective.error_limit_m > 0) {
    description.limits.push_back({{describe_error(objective), "m"}, objective.error_limit_m});
  }
  if (objective.total_torque_limit_n_m > 0) {
    description.limits.push_back({{"total torque", "N m"}, objective.total_torque_limit_n_m});
  }
  description.metrics = {{"error", "m"},
                         {"total_torque", "N m"},
                         {"failures", "1"},
                         {"energy", "J"},
                         {"saturated_share", "1"}};
  if (has_duration_metric(config)) {
    description.metrics.push_back({"duration", "s"});
  }
  if (has_mass_metric(config)) {
    description.metrics.push_back({"moving_mass", "kg"});
  }
  if (has_deflection_metric(config)) {
    description.metrics.push_back({"deflection", "m"});
  }
  for (const Joint& joint : config.robot.joints) {
    const std::string unit = get_joint_unit("N m", joint.kind);
    description.metrics.push_back({joint.name + ".peak_effort", unit});
    description.metrics.push_back({joint.name + ".rms_effort", unit});
  }
  const bool objective_has_limit = !description.limits.empty();
  if (config.tubes.deflection_limit_m) {
    description.limits.push_back({{"deflection", "m"}, *config.tubes.deflection_limit_m});
  }
  describe_requirements(config.requirements, config.robot, description);
  if (!description.limits.empty() && !objective_has_limit && !objective.logarithm &&
      !objective.is_sum() && objective.kind != TrackingObjective::Kind::front) {
    description.violation_scale = objective.error_scale_m;
  }
  for (const Limit& limit : description.limits) {
    description.constraints.push_back({limit.quantity.name + " / limit - 1", "1"});
  }
  description.has_residuals = objective.has_residuals() && description.limits.empty();
  if (!description.has_residuals && description.limits.empty()) {
    description.residuals_advice =
        objective.statistic == TrackingObjective::Statistic::mean
            ? "only fronts of error, torque, energy and duration, with the error among them, have "
              "residuals; change objective.quantities or choose another optimizer"
            : "only objective.statistic = \"mean\" has residuals; choose it or another optimizer";
  }
  return description;
}

}  // namespace armwright
