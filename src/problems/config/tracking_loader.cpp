// Loads a tracking problem: reads its whole file and makes the problem.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/config/plant_file.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/robot/mesh_file.hpp"
#include "sim/robot/mesh_finder.hpp"
#include "sim/tracking/elasticity.hpp"

namespace armwright {

const Setting<std::string> kRobotUrdf{
    "urdf", kNoDefault,
    "the robot: a URDF or MJCF file beside this one, or the name of a shipped one"};

namespace {

const Setting<std::string> kRobotBase{"base", "",
                                      "link that stands still (default: the root of the tree)"};
const Setting<std::string> kRobotTip{
    "tip", "",
    "link whose frame is the tool (default: the end of the chain that is clearly the tool)"};
const Setting<double> kRobotDensity{
    "density_kg_per_m3",
    {.lower = 1, .upper = 30'000},
    0,
    "density that gives links without <inertial> the mass of their shapes; 0: such links are "
    "refused"};
const Setting<bool> kRobotRepair{
    "repair", RobotOptions{}.repair,
    "whether bad inertias of moving links are corrected and missing masses assumed, each with a "
    "note (the problem robot, which --robot uses, has true); false: such files are refused"};
const Setting<bool> kRobotMassFromShapes{
    "mass_from_shapes", RobotOptions{}.mass_from_shapes,
    "with robot.repair and without a density: whether missing masses are those of the shapes at "
    "1000 kg/m3, if all can be read; false: they follow from the arm's lengths"};
const Setting<std::vector<std::string>> kRobotPackages{
    "packages", std::vector<std::string>{},
    "folders of the packages in package:// paths, each NAME=DIR; DIR is relative to this file"};
const Setting<double> kRobotMassScale{"mass_scale",
                                      {.lower = 0.01, .upper = 100},
                                      TrackingConfig{}.mass_scale,
                                      "factor on every mass and inertia of the robot"};
const Setting<bool> kRobotDynamics{"dynamics", RobotOptions{}.dynamics,
                                   "whether joints have the friction of <dynamics> in the URDF, or "
                                   "the rotors, friction and springs "
                                   "of an MJCF file, and a proposed start its effort limits (the "
                                   "problem robot, which --robot uses, "
                                   "has true)"};
const Setting<std::string> kRobotPlant{
    "plant", "",
    "file with rotor inertia, friction, elasticity and counterbalances of the joints; auto: "
    "FILE.plant.toml beside the robot FILE.urdf, if it exists (the problem robot has auto)"};
constexpr Range kPlantFactor{.lower = 0.01, .upper = 100};
const Setting<double> kRobotFrictionScale{"friction_scale",
                                          {.lower = 0, .upper = 100},
                                          PlantScales{}.friction,
                                          "factor on all friction of the robot's joints"};
const Setting<double> kRobotArmatureScale{
    "armature_scale", kPlantFactor, PlantScales{}.armature,
    "factor on the armatures of the robot's joints, also on those of armature_share"};
const Setting<double> kRobotStiffnessScale{
    "stiffness_scale", kPlantFactor, PlantScales{}.stiffness,
    "factor on the stiffness and damping of the robot's elastic joints, also on those of "
    "elastic_hz"};
const Setting<double> kRobotArmatureShare{
    "armature_share",
    {.lower = 0, .upper = 10},
    PlantScales{}.armature_share,
    "joints without armature get this share of the inertia that they move in the middle of the "
    "ranges"};
const Setting<double> kRobotElastic{
    "elastic_hz",
    {.lower = 0, .upper = 1000},
    PlantScales{}.elastic_hz,
    "rigid joints become elastic: on a held link, their motors swing at this frequency; needs "
    "armatures; 0: they stay rigid"};
const Setting<bool> kRobotPropose{
    "propose", false,
    "whether values that the file leaves out of workspace, pace and controllers are proposed from "
    "the URDF"};

const Setting<double> kTrainingCutoff{
    "cutoff_error_m",
    {.lower = kFailureError_m, .upper = 1e6},
    TrackingConfig{}.cutoff_error_m,
    "a training case ends at this error (m); training.failure_rule says what it then counts"};
const Setting<std::string> kTrainingFailureRule{
    "failure_rule", failure_rule_names, "ordered",
    "what a training case counts in which the arm loses its target; ordered: more than any case "
    "in which it does not, the more the earlier it ended, and with the largest torque and energy; "
    "thesis: its remaining points count as cutoff_error_m, and torque and energy as they are"};

const Setting<double> kMotorsTorquePerMass{
    "torque_per_mass_n_m_per_kg",
    {.lower = 0, .upper = 1e9},
    TrackingConfig{}.torque_per_mass_n_m_per_kg,
    "every joint carries a motor with the mass effort limit / this; 0: motors have no mass"};

// Reads the changes of the plants and applies them to the robot.
void scale_plants_of(const ConfigTable& table, TrackingConfig& config) {
  config.plant_scales = {.friction = table.get(kRobotFrictionScale),
                         .armature = table.get(kRobotArmatureScale),
                         .stiffness = table.get(kRobotStiffnessScale),
                         .armature_share = table.get(kRobotArmatureShare),
                         .elastic_hz = table.get(kRobotElastic)};
  if (config.plant_scales == PlantScales{}) {
    return;
  }
  config.robot = scale_plants(std::move(config.robot), config.plant_scales);
  if (config.plant_scales.elastic_hz > 0 &&
      std::ranges::none_of(config.robot.joints,
                           [](const Joint& joint) { return joint.plant.is_elastic(); })) {
    table.refuse(kRobotElastic,
                 "none of the robot's joints has an armature, which an elastic joint needs; give "
                 "robot.armature_share, or armatures in the file of robot.plant");
  }
}

std::shared_ptr<const TrackingProblem> make_tracking(TrackingConfig config,
                                                     const ConfigTable& variables,
                                                     const std::filesystem::path& urdf) {
  std::shared_ptr<const TrackingProblem> problem;
  try {
    name_robot_file(urdf, [&] { problem = std::make_shared<TrackingProblem>(std::move(config)); });
    return problem;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) {
      throw;
    }
    variables.refuse(kVariablesStart, error.what());
  }
}

// Refuses, in [physics], steps that cannot simulate the swinging of an elastic joint. `plant` is the
// robot's plant file, or empty.
void check_elasticity(const ConfigTable& physics, const TrackingConfig& config,
                      const std::filesystem::path& plant) {
  const RobotModel fastest = make_fastest_arm(config.robot, config.perturbation);
  const auto mode = find_fastest_mode(fastest);
  if (!mode) {
    return;
  }
  const double period_s = config.task.control_period_s;
  const int needed = count_substeps(*mode, period_s);
  if (config.task.physics.substeps >= needed) {
    return;
  }
  const Joint& joint = config.robot.joints[mode->joint];
  const double step_s = period_s / config.task.physics.substeps;
  const double most = kPhysicsSubsteps.range.upper;
  // One per cent less than the longest period: three digits may round it up.
  const std::string advice =
      needed <= most
          ? fmt::format("set physics.substeps to {} or more", needed)
          : fmt::format("set physics.substeps to {} and control.period_s to {:.3g} or less", most,
                        0.99 * most * kMostTurnPerStep_rad / mode->rate_rad_per_s);
  physics.refuse(
      kPhysicsSubsteps,
      fmt::format(
          "the spring of joint '{}' (stiffness {:.6g} {}{}) moves at {:.4g} rad/s{}, which "
          "is {:.3g} rad per step of {:.4g} s; at most {} rad can be simulated: {}, or make "
          "the joint less stiff or less damped",
          sanitize(joint.name), joint.plant.stiffness,
          joint.kind == JointKind::prismatic ? "N/m" : "N m/rad",
          plant.empty() ? "" : ", " + sanitize(plant.string()), mode->rate_rad_per_s,
          config.perturbation.changes_arm() ? " in the fastest of the perturbed plants" : "",
          mode->rate_rad_per_s * step_s, step_s, kMostTurnPerStep_rad, advice));
}

// Makes the tool's orientation count where the path says how the tool is turned and the file leaves
// that open.
void apply_turns(const ConfigTable& table, TrackingConfig& config) {
  const ConfigTable task = table.get_table_or_empty(kTaskSettings);
  if (task.has(kTaskOrientation)) {
    return;
  }
  if (config.task.kinematics == KinematicsChoice::palletiser) {
    task.refuse("kinematics",
                "the path says how the tool is turned, and the closed form of a palletiser says "
                "nothing of that; set it to \"numeric\", or leave the turns out of the path");
  }
  config.task.tool.orientation = ToolOrientation::pose;
  task.settle(kTaskOrientation,
              tool_orientation_names()[static_cast<std::size_t>(config.task.tool.orientation)]);
}

// Refuses a path that says how the tool is turned if that does not count.
void check_turns(const ConfigTable& table, const TrackingConfig& config) {
  if (!config.path || config.path->turns.empty() ||
      config.task.tool.orientation != ToolOrientation::free) {
    return;
  }
  const bool is_said = table.get_table_or_empty(kTaskSettings).has(kTaskOrientation);
  table.get_table_or_empty(kPathSettings)
      .refuse("kind",
              is_said
                  ? "the path says how the tool is turned, which does not count where "
                    "task.orientation is \"free\"; set that to \"pose\" or \"pointing\", or "
                    "leave it out"
                  : fmt::format("the path says how the tool is turned, but the {} joints of the "
                                "arm cannot turn it as they move it; leave the turns out of "
                                "the path",
                                config.robot.joint_count()));
}

// Reads the path, if there is one, and proposes what is left out.
void read_path_and_proposal(const ConfigTable& table, TrackingConfig& config,
                            LoadedProblem& loaded) {
  config.path = read_path(table.get_table_or_empty(kPathSettings), config.task, loaded);
  if (config.path) {
    // The user chose every move, so that the first one counts unless the file says otherwise.
    config.task.count_first_point =
        table.get_table_or_empty(kTaskSettings).get_or(kTaskCountFirstPoint, true);
  }
  if (table.get_table(kRobotSettings).get(kRobotPropose)) {
    apply_proposal(table, config);
  } else if (config.path && !config.path->turns.empty()) {
    apply_turns(table, config);
  }
  check_turns(table, config);
}

// Returns the plant's file, and settles its name. Empty: there is none.
std::filesystem::path find_plant(const ConfigTable& table, const std::filesystem::path& urdf) {
  const std::string named = table.get(kRobotPlant);
  if (named != kPlantBeside) {
    if (named.empty()) {
      table.leave_out(kRobotPlant);  // so recorded version 1.0
      return "";
    }
    return resolve_named(table, kRobotPlant, "plants");
  }
  const std::filesystem::path beside = name_plant_file(urdf);
  if (!path_exists(beside)) {
    table.leave_out(kRobotPlant);
    return "";
  }
  // A record is read where the URDF is found, so the name is that of the URDF.
  table.settle(kRobotPlant, name_plant_file(table.get(kRobotUrdf)).string());
  return beside;
}

std::map<std::string, std::filesystem::path> read_packages(const ConfigTable& table) {
  const std::vector<std::string> texts = table.get(kRobotPackages);
  std::map<std::string, std::filesystem::path> packages;
  std::vector<std::string> settled;
  for (const std::string& text : texts) {
    const auto package = parse_package(text);
    if (!package) {
      table.refuse(kRobotPackages, "each must be NAME=DIR");
    }
    const std::filesystem::path folder =
        std::filesystem::absolute(table.file().parent_path() / package->second).lexically_normal();
    packages[package->first] = folder;
    settled.push_back(fmt::format("{}={}", package->first, folder.string()));
  }
  if (texts.empty()) {
    table.leave_out(kRobotPackages);
  } else {
    table.settle(kRobotPackages, settled);
  }
  return packages;
}

// Records what the reader of the robot chose, so that a record is read in the same way wherever its
// files are.
void settle_reading(const ConfigTable& table, const RobotReading& reading) {
  if (reading.is_tip_proposed) {
    table.settle(kRobotTip, reading.tip);
  }
  if (!table.get(kRobotRepair)) {
    table.leave_out(kRobotRepair);
  }
  if (reading.density_kg_per_m3 > 0 && table.get(kRobotDensity) == 0) {
    table.settle(kRobotDensity, reading.density_kg_per_m3);
  }
  if (reading.assumed_links.empty() || reading.density_kg_per_m3 > 0) {
    table.leave_out(kRobotMassFromShapes);
  } else {
    table.settle(kRobotMassFromShapes, false);
  }
}

// Refuses robots without a motor, and tasks that unactuated joints cannot have.
void check_unactuated_joints(const ConfigTable& table, const TrackingConfig& config) {
  const std::vector<Joint>& joints = config.robot.joints;
  const auto first = std::ranges::find_if(joints, [](auto& one) { return one.plant.unactuated; });
  if (first == joints.end()) {
    return;
  }
  const std::string name = sanitize(first->name);
  if (std::ranges::all_of(joints, [](auto& one) { return one.plant.unactuated; })) {
    table.get_table(kRobotSettings)
        .refuse(kRobotPlant,
                fmt::format("all joints are unactuated ('{}' first); at least one must "
                            "have a motor",
                            name));
  }
  if (config.task.kinematics == KinematicsChoice::palletiser) {
    table.get_table_or_empty(kTaskSettings)
        .refuse("kinematics",
                fmt::format("joint '{}' is unactuated, which the closed form does not know; set it "
                            "to \"numeric\"",
                            name));
  }
  for (std::size_t i = 0; i < config.task.home.size(); ++i) {
    if (joints[i].plant.unactuated && config.task.home[i] != 0) {
      table.get_table_or_empty(kTaskSettings)
          .refuse(kTaskHome, fmt::format("joint '{}' is unactuated; its position must be 0, where "
                                         "its spring is relaxed",
                                         sanitize(joints[i].name)));
    }
  }
  const ConfigTable control = table.get_table_or_empty(kControlSettings);
  if (static_cast<ControlInterface>(control.get_choice(kControlInterface)) !=
      ControlInterface::effort) {
    control.refuse(
        kControlInterface,
        fmt::format("joint '{}' is unactuated; drives with inner loops are simulated for "
                    "arms without such joints; set it to \"effort\"",
                    name));
  }
}

ReadRobot load_robot(const ConfigTable& table, const std::filesystem::path& urdf,
                     LoadedProblem& loaded) {
  RobotOptions options;
  options.base = table.get(kRobotBase);
  options.tip = table.get(kRobotTip);
  options.density_kg_per_m3 = table.get(kRobotDensity);
  options.dynamics = table.get(kRobotDynamics);
  if (!options.dynamics) {
    table.leave_out(kRobotDynamics);
  }
  options.repair = table.get(kRobotRepair);
  options.mass_from_shapes = table.get(kRobotMassFromShapes);
  options.packages = read_packages(table);
  const std::filesystem::path plant = find_plant(table, urdf);
  try {
    ReadRobot all;
    all.robot = load_urdf(urdf, options);
    all.plain = all.robot;
    all.plant = plant;
    RobotModel& robot = all.robot;
    settle_reading(table, robot.reading);
    add_input(loaded, urdf);
    for (const auto& [name, path] : robot.mass_files) {
      loaded.input_hashes[name] = calc_sha256_hex(read_file(path, kMeshFileLimit_bytes));
    }
    if (!plant.empty()) {
      all.fitted = load_plant(plant, robot);
      add_input(loaded, plant);
    }
    return all;
  } catch (const RobotOptionError& error) {
    table.refuse(table.has(error.option()) ? error.option() : kRobotUrdf.key, error.what());
  }
}

}  // namespace

const SettingTable kRobotSettings{
    .key = "robot",
    .settings = {&kRobotUrdf, &kRobotBase, &kRobotTip, &kRobotDensity, &kRobotRepair,
                 &kRobotMassFromShapes, &kRobotPackages, &kRobotMassScale, &kRobotDynamics,
                 &kRobotPlant, &kRobotFrictionScale, &kRobotArmatureScale, &kRobotStiffnessScale,
                 &kRobotArmatureShare, &kRobotElastic, &kRobotPropose}};
const SettingTable kTrainingSettings{.key = "training",
                                     .settings = {&kTrainingCutoff, &kTrainingFailureRule}};
const SettingTable kMotorSettings{.key = "motors", .settings = {&kMotorsTorquePerMass}};

void name_robot_file(const std::filesystem::path& urdf, const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_data) {
      throw;
    }
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", sanitize(urdf.string()), error.what()));
  }
}

void check_floor(const ConfigTable& table, const Setting<double>& setting, double floor_m,
                 const RobotModel& robot) {
  const double base_m = robot.joints.front().origin.translation().z();
  if (floor_m > base_m) {
    table.refuse(setting,
                 fmt::format("the arm's first joint is lower, at {:.6g} m; the floor must not be "
                             "above it (heights are z in the frame of the root link)",
                             base_m));
  }
}

ReadRobot read_robot(const ConfigTable& table, LoadedProblem& loaded) {
  ReadRobot read = load_robot(table, resolve_named(table, kRobotUrdf, "robots"), loaded);
  for (const Joint& joint : read.robot.joints) {
    if (joint.plant.unactuated) {
      table.refuse(kRobotPlant, fmt::format("joint '{}' is unactuated; such a robot cannot be "
                                            "identified or excited, only simulated and tuned",
                                            sanitize(joint.name)));
    }
  }
  return read;
}

void load_tracking(const ConfigTable& table, std::span<const EngineRow> engines,
                   LoadedProblem& loaded) {
  TrackingConfig config;
  config.name = loaded.name;
  config.summary = loaded.title;
  const ConfigTable robot = table.get_table(kRobotSettings);
  const auto urdf = resolve_named(robot, kRobotUrdf, "robots");
  config.mass_scale = robot.get(kRobotMassScale);
  ReadRobot read = load_robot(robot, urdf, loaded);
  config.robot = scale_masses(std::move(read.robot), config.mass_scale);
  if (read.fitted) {
    config.fitted_plant = std::make_shared<FittedPlant>(*std::move(read.fitted));
  }
  read_task_tubes(table, config);  // before shares of the inertia that joints move are taken
  scale_plants_of(robot, config);
  config.own_effort_limits = robot.get(kRobotDynamics);

  const ConfigTable physics = table.get_table_or_empty(kPhysicsSettings);
  config.engines = read_engines(physics, engines);
  const ConfigTable task = table.get_table_or_empty(kTaskSettings);
  const ConfigTable control = table.get_table_or_empty(kControlSettings);
  config.task = read_task(task, control);
  config.task.physics = read_physics(physics);
  if (!config.task.home.empty() && config.task.home.size() != config.robot.joint_count()) {
    task.refuse(kTaskHome, fmt::format("it must hold {} numbers, one a joint of the robot",
                                       config.robot.joint_count()));
  }
  check_unactuated_joints(table, config);
  if (config.task.floor_m) {
    check_floor(task, kTaskFloor, *config.task.floor_m, config.robot);
  }
  read_task_clearance(table, urdf, config, loaded);
  config.workspace = read_workspace(table.get_table_or_empty(kWorkspaceSettings));
  name_robot_file(urdf, [&] { read_path_and_proposal(table, config, loaded); });
  read_drives(control, config.task);  // they need the final control period
  check_length(task, control, config);
  config.objective = read_objective(table.get_table_or_empty(kObjectiveSettings));
  const ConfigTable training = table.get_table_or_empty(kTrainingSettings);
  config.cutoff_error_m = training.get(kTrainingCutoff);
  config.failure_rule = static_cast<FailureRule>(training.get_choice(kTrainingFailureRule));
  training.settle(kTrainingFailureRule, training.get(kTrainingFailureRule));

  const ConfigTable variables = table.get_table(kVariableSettings);
  read_variables(variables, control, urdf, config, loaded);
  config.torque_per_mass_n_m_per_kg =
      table.get_table_or_empty(kMotorSettings).get(kMotorsTorquePerMass);
  config.perturbation =
      read_perturbation(table.get_table_or_empty(kPerturbationSettings),
                        {config.robot, config.start, config.fitted_plant}, loaded);
  check_elasticity(physics, config, read.plant);
  check_load(task, table.get_table_or_empty(kPerturbationSettings), config);
  config.requirements = read_requirements(table.get_tables_or_empty(kRequirementSettings), config);
  read_front(table.get_table_or_empty(kObjectiveSettings), config);
  check_limits(table.get_table_or_empty(kObjectiveSettings), config);
  loaded.problem = make_tracking(std::move(config), variables, urdf);
  settle_solver(task, loaded.tracking()->setup());
}

}  // namespace armwright
