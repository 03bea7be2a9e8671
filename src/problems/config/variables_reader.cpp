// Reads the decision variables of a problem: their start and bounds.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/gains_file.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "sim/tracking/design.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {

const Setting<std::string> kVariablesStart{
    "start", kNoDefault,
    "design to start from: a file beside this one, the name of a shipped design, proposed, or "
    "gains of ros2_control (FILE.yaml)"};

const Setting<double> kVariablesStartBandwidth{
    "start_bandwidth_rad_per_s",
    {.lower = 0, .upper = 1000},
    kNoDefault,
    "bandwidth of the controllers of a proposed start (default: 10, or another one where "
    "simulations of the start diverge or fail); 0: as version 1.0, whose records lack this key"};

namespace {

constexpr Range kFactor{.lower = 1, .upper = 100, .lower_open = true};

const Setting<std::vector<std::string>> kVariablesOptimize{
    "optimize", kNoDefault,
    "decision variables of every joint: gains for all gains, names of single gains of the "
    "controller, effort_min, effort_max, length_scale, section_scale, and with [tubes] "
    "tube_diameter and tube_wall (default: gains, effort_min and effort_max)"};
const Setting<std::vector<std::string>> kVariablesTask{
    "task", kNoDefault, "[\"speed\"]: the nominal speed is a decision variable too"};
const Setting<double> kVariablesBounds{
    "bounds_factor",
    {.lower = 1, .upper = 1e9, .lower_open = true},
    TrackingConfig{}.bounds_factor,
    "bounds of gains and effort limits: the start divided by this, and times this"};
const Setting<double> kVariablesLengthBounds{
    "length_bounds_factor", kFactor, TrackingConfig{}.length_bounds_factor,
    "bounds of length_scale: the start divided by this, and times this"};
const Setting<double> kVariablesSectionBounds{
    "section_bounds_factor", kFactor, TrackingConfig{}.section_bounds_factor,
    "bounds of section_scale: the start divided by this, and times this"};
const Setting<double> kVariablesSpeedBounds{
    "speed_bounds_factor", kFactor, TrackingConfig{}.speed_bounds_factor,
    "bounds of the speed: the start divided by this, and times this"};
const Setting<bool> kVariablesWithinEffort{"within_effort_limits",
                                           TrackingConfig{}.within_effort_limits,
                                           "whether effort limits stay within those of the URDF"};

const Setting<std::string> kJointVariablesName{
    "name", kNoDefault, "name of a joint of the robot that has a list of its own"};
const Setting<std::vector<std::string>> kJointVariablesOptimize{
    "optimize", kNoDefault, "decision variables of this joint, in place of variables.optimize"};
const SettingTable kJointVariableSettings{
    .key = "joint", .is_array = true, .settings = {&kJointVariablesName, &kJointVariablesOptimize}};

// Sets the start of the speed, which is a decision variable. Refuses bounds if a test case at the
// lowest speed is longer than kMostPeriods.
void set_start_speed(const ConfigTable& variables, TrackingConfig& config) {
  TrackingTask slowest = make_task(config.task, config.start);
  config.start.speed_m_per_s = slowest.speed_m_per_s;
  slowest.speed_m_per_s /= config.speed_bounds_factor;
  const double periods = calc_case_duration_s(config, slowest) / slowest.control_period_s;
  if (periods > kMostPeriods) {
    variables.refuse(
        variables.has(kVariablesSpeedBounds) ? kVariablesSpeedBounds.key : kVariablesTask.key,
        fmt::format("a test case at the slowest speed would take {:.3g} control periods, possible "
                    "are {:.3g}; lower speed_bounds_factor",
                    periods, kMostPeriods));
  }
}

// Returns the controller that the problem names. Without a name it is that of the start or, if that
// does not command what the drives take, the first one that does.
std::string choose_controller(const ConfigTable& control, const TrackingConfig& config) {
  const ControlInterface interface = config.task.drives.interface;
  if (const auto name = control.find(kControlController)) {
    return *name;
  }
  const std::string& own = config.start.controller;
  if (interface == ControlInterface::effort || find_controller(own).interface == interface) {
    return own;
  }
  return get_plain_controller(interface).name;
}

// Converts the start to the controller of the problem, and asks for the feed-forward that the
// controller needs.
void apply_controller(const ConfigTable& control, TrackingConfig& config) {
  const ArmDrives& drives = config.task.drives;
  const std::string name = choose_controller(control, config);
  const AnySetting& source =
      control.has(kControlController) ? kControlController : kControlInterface;
  try {
    check_interface(find_controller(name), drives);
    config.start =
        convert_design(config.start, name, config.task.control_period_s, drives.calc_lag_s());
  } catch (const Error& error) {
    control.refuse(source, error.what());
  }
  config.task.feed_forward = find_controller(config.start.controller).feed_forward;
}

// Refuses names of sizes that the problem's links do not have, and of sizes without bounds.
void check_tube_name(const ConfigTable& table, const AnySetting& optimize, const std::string& name,
                     const ArmTubes& tubes) {
  const bool is_wall = name == "tube_wall";
  if (!tubes.tubes.empty() && name == "section_scale") {
    table.refuse(optimize,
                 "the links are tubes ([tubes]), so that section_scale cannot be a variable; "
                 "tube_diameter and tube_wall take its place");
  }
  if (name != "tube_diameter" && !is_wall) {
    return;
  }
  if (tubes.tubes.empty()) {
    table.refuse(optimize,
                 fmt::format("the links are no tubes; add [tubes], or leave out '{}'", name));
  }
  if (!(is_wall ? tubes.wall_m : tubes.diameter_m)) {
    table.refuse(optimize, fmt::format("'{}' has no bounds; add tubes.{}", name,
                                       is_wall ? "wall_bounds_m" : "diameter_bounds_m"));
  }
}

// Refuses bounds of sizes that are no variables, and walls of the start that are, or can become,
// thicker than the radius. read_tubes() checks those of [tubes].
void check_tube_bounds(const ConfigTable& table, const TrackingConfig& config) {
  using Kind = DesignParameter::Kind;
  const std::tuple<const std::optional<VariableBounds>&, Kind, const char*, const char*> rows[] = {
      {config.tubes.diameter_m, Kind::tube_diameter, "tube_diameter", "diameter_bounds_m"},
      {config.tubes.wall_m, Kind::tube_wall, "tube_wall", "wall_bounds_m"}};
  for (const auto& [bounds, kind, name, key] : rows) {
    if (bounds && std::ranges::find(config.parameters, kind, &DesignParameter::kind) ==
                      config.parameters.end()) {
      table.refuse(kVariablesOptimize,
                   fmt::format("tubes.{0} bounds '{1}', which is no variable; add '{1}', or leave "
                               "out tubes.{0}",
                               key, name));
    }
  }
  const ArmTubes& tubes = config.tubes;
  for (std::size_t i = 0; i < tubes.tubes.size(); ++i) {
    const Tube& tube = config.start.joints[i].tube;
    const double thickest = tubes.wall_m ? tubes.wall_m->upper : tube.wall_m;
    const double thinnest = tubes.diameter_m ? tubes.diameter_m->lower : tube.diameter_m;
    if (2 * thickest > thinnest) {
      table.refuse(
          kVariablesStart,
          fmt::format("the wall of link '{}' can be {:g} m, thicker than the radius of its "
                      "tube, {:g} m; make it thinner in the design, or change the bounds "
                      "in [tubes]",
                      sanitize(config.robot.links[i].name), thickest, thinnest / 2));
    }
  }
}

// Returns the numbers of the design that are decision variables, in the order of the decision
// vector: joint by joint the gains, effort limits, scales and sizes of tubes, last the speed.
std::vector<DesignParameter> read_parameters(const ConfigTable& table,
                                             const TrackingConfig& config) {
  const ControllerRow& controller = find_controller(config.start.controller);
  std::vector<std::string> valid;
  for (const controllers::Gain& gain : controller.gains) {
    valid.push_back(gain.name);
  }
  const std::vector<std::string> gains = valid;
  valid.insert(valid.end(), {"effort_min", "effort_max"});
  const std::vector<std::string> drives = valid;
  valid.insert(valid.end(), {"length_scale", "section_scale", "tube_diameter", "tube_wall"});
  const auto read_names = [&](const ConfigTable& where,
                              const Setting<std::vector<std::string>>& optimize) {
    std::vector<std::string> names;
    for (const std::string& name : where.get(optimize)) {
      if (name == "gains") {  // every gain of the controller
        names.insert(names.end(), gains.begin(), gains.end());
      } else {
        names.push_back(name);
      }
    }
    for (auto name = names.begin(); name != names.end(); ++name) {
      if (std::find(valid.begin(), valid.end(), *name) == valid.end()) {
        std::vector<std::string> known = {"gains"};
        known.insert(known.end(), valid.begin(), valid.end());
        where.refuse(optimize, describe_unknown("design parameter", *name, known));
      }
      check_tube_name(where, optimize, *name, config.tubes);
      if (std::find(names.begin(), name, *name) != name) {
        where.refuse(optimize, fmt::format("'{}' stands there twice; name it once", *name));
      }
    }
    return names;
  };
  const std::size_t joints = config.robot.joint_count();
  std::vector<std::vector<std::string>> chosen(
      joints, table.has(kVariablesOptimize) ? read_names(table, kVariablesOptimize) : drives);
  std::vector<std::string> joint_names;
  for (const Joint& joint : config.robot.joints) {
    joint_names.push_back(joint.name);
  }
  std::vector<std::string> named;
  for (const ConfigTable& joint : table.get_tables_or_empty(kJointVariableSettings)) {
    const std::string name = joint.get(kJointVariablesName.among(joint_names));
    if (std::find(named.begin(), named.end(), name) != named.end()) {
      joint.refuse(kJointVariablesName,
                   "another [[variables.joint]] has that name; put them together");
    }
    named.push_back(name);
    const auto found = std::find(joint_names.begin(), joint_names.end(), name);
    if (config.robot.joints[static_cast<std::size_t>(found - joint_names.begin())]
            .plant.unactuated) {
      joint.refuse(kJointVariablesName,
                   "that joint is unactuated, so it has no controller to tune");
    }
    chosen[static_cast<std::size_t>(found - joint_names.begin())] =
        read_names(joint, kJointVariablesOptimize);
  }
  std::vector<DesignParameter> parameters;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    if (config.robot.joints[joint].plant.unactuated) {
      continue;
    }
    for (std::size_t i = 0; i < valid.size(); ++i) {
      if (std::find(chosen[joint].begin(), chosen[joint].end(), valid[i]) == chosen[joint].end()) {
        continue;
      }
      DesignParameter parameter;
      parameter.joint = joint;
      constexpr std::array kOthers = {
          DesignParameter::Kind::effort_min,    DesignParameter::Kind::effort_max,
          DesignParameter::Kind::length_scale,  DesignParameter::Kind::section_scale,
          DesignParameter::Kind::tube_diameter, DesignParameter::Kind::tube_wall};
      parameter.kind = i < gains.size() ? DesignParameter::Kind::gain : kOthers[i - gains.size()];
      parameter.gain = i;
      parameters.push_back(parameter);
    }
  }
  if (const auto names = table.find(kVariablesTask)) {
    if (*names != std::vector<std::string>{"speed"}) {
      table.refuse(kVariablesTask, "the task has one variable; write [\"speed\"] or leave it out");
    }
    DesignParameter speed;
    speed.kind = DesignParameter::Kind::speed;
    parameters.push_back(speed);
  }
  if (parameters.empty()) {
    table.refuse(kVariablesOptimize,
                 "at least one design parameter of one joint must be optimized");
  }
  return parameters;
}

}  // namespace

const SettingTable kVariableSettings{
    .key = "variables",
    .settings = {&kVariablesStart, &kVariablesStartBandwidth, &kVariablesOptimize, &kVariablesTask,
                 &kVariablesBounds, &kVariablesLengthBounds, &kVariablesSectionBounds,
                 &kVariablesSpeedBounds, &kVariablesWithinEffort},
    .tables = {&kJointVariableSettings}};

void read_variables(const ConfigTable& variables, const ConfigTable& control,
                    const std::filesystem::path& urdf, TrackingConfig& config,
                    LoadedProblem& loaded) {
  const bool is_proposed = variables.get(kVariablesStart) == kProposedStart;
  if (variables.find(kVariablesStartBandwidth) && !is_proposed) {
    variables.refuse(kVariablesStartBandwidth,
                     "it belongs to a proposed start; leave it out, or set variables.start to "
                     "\"proposed\"");
  }
  if (is_proposed) {
    name_robot_file(urdf, [&] { config.start = propose_start(variables, config); });
  } else if (is_gains_file(variables.get(kVariablesStart))) {
    const auto start = resolve_named(variables, kVariablesStart, "gains");
    config.start = load_gains(start, config.robot, config.task.drives);
    add_input(loaded, start);
  } else {
    const auto start = resolve_named(variables, kVariablesStart, "designs");
    config.start = load_design(start.string()).design;
    add_input(loaded, start);
  }
  config.within_effort_limits = variables.get(kVariablesWithinEffort);
  config.bounds_factor = variables.get(kVariablesBounds);
  if (config.start.joints.size() != config.robot.joint_count()) {
    variables.refuse(kVariablesStart,
                     fmt::format("that design has {} joints and robot '{}' has {}; designs are "
                                 "made for one robot: take another robot.urdf, or start from a "
                                 "design made for this one (variables.start=proposed makes one)",
                                 config.start.joints.size(), sanitize(config.robot.name),
                                 config.robot.joint_count()));
  }
  try {
    check_unactuated(config.start, config.robot);
  } catch (const Error& error) {
    variables.refuse(kVariablesStart, error.what());
  }
  apply_controller(control, config);
  for (std::size_t i = 0; i < config.tubes.tubes.size(); ++i) {
    if (config.start.joints[i].tube.diameter_m == 0) {
      config.start.joints[i].tube = config.tubes.tubes[i];
    }
  }
  config.parameters = read_parameters(variables, config);
  check_tube_bounds(variables, config);
  config.length_bounds_factor = variables.get(kVariablesLengthBounds);
  config.section_bounds_factor = variables.get(kVariablesSectionBounds);
  config.speed_bounds_factor = variables.get(kVariablesSpeedBounds);
  if (changes_speed(config)) {
    set_start_speed(variables, config);
  }
}

}  // namespace armwright
