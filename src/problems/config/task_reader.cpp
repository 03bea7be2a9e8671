// Reads the task of a problem: its signal, tool, times and workspace.

#include <fmt/format.h>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {

const Setting<std::string> kTaskOrientation{
    "orientation", tool_orientation_names, "free",
    "which part of the tool's orientation counts beside its position: none, the direction of its "
    "axis, or the whole pose (default: free; with a [path] that turns the tool pose)"};
const Setting<bool> kTaskCountFirstPoint{
    "count_first_point", TrackingTask{}.count_first_point,
    "whether the first move, which starts from rest, counts (default: false; with a [path] true)"};
const Setting<double> kTaskSpeed{"speed_m_per_s",
                                 {.lower = 1e-4, .upper = 100},
                                 TrackingTask{}.speed_m_per_s,
                                 "nominal speed of the target"};
const Setting<double> kTaskDistanceLimit{
    "distance_limit_m",
    {.lower = 0, .upper = 100},
    TrackingTask{}.distance_limit_m,
    "a move shorter than this takes as long as a move of this length"};
const Setting<double> kTaskFloor{
    "floor_m",
    {.lower = -1000, .upper = 1000},
    kNoDefault,
    "height in the world below which no link may be; path checks and proposals keep to it "
    "(default: "
    "no floor; a proposed workspace has one at 0 if the arm can work above it)"};
const Setting<std::string> kTaskLimits{
    "limits", limit_policy_names, "ignore",
    "what happens if a path exceeds joint ranges or speeds, or meets singularities, the floor or "
    "obstacles: nothing, a warning or an error"};
const Setting<double> kTaskClearance{
    "clearance_m",
    {.lower = 0, .upper = 10},
    kNoDefault,
    "least distance of the links from every [[obstacle]], and from each other with self_clearance; "
    "path checks and proposals keep to it (default: 0)"};
const Setting<bool> kTaskSelfClearance{
    "self_clearance", false, "whether links must stay clear of each other and of the base too"};
const Setting<std::vector<double>> kTaskHome{
    "home",
    {.lower = -1000, .upper = 1000},
    kNoDefault,
    "joint positions where the search for the first posture begins: one number per joint, rad or m "
    "(default: the middle of the ranges)"};
const Setting<std::vector<double>> kTaskLoadCom{
    "load_com_m",
    {.lower = -100, .upper = 100},
    kNoDefault,
    "the load's centre of mass in the tip's frame, three numbers (default: the load is a steel "
    "block on the flange)"};
const Setting<std::vector<double>> kTaskToolRpy{
    "tool_rpy_rad", kAngleRange, kNoDefault,
    "orientation of the tool in the world: roll, pitch and yaw, three numbers"};

const Setting<std::vector<double>> kTaskToolAxis{
    "tool_axis", kDirectionRange, kNoDefault,
    "direction in the tip's frame that points, three numbers (default: z)"};

const Setting<double> kControlPeriod{"period_s",
                                     {.lower = 1e-5, .upper = 0.1},
                                     TrackingTask{}.control_period_s,
                                     "sample period of the controllers"};

const Setting<std::string> kControlController{
    "controller", controller_names, kNoDefault,
    "control law of all joints (armwright list controllers; default: that of the start)"};

const Setting<std::vector<double>> kWorkspaceCentre{
    "centre_m",
    {.lower = -1000, .upper = 1000},
    kNoDefault,
    "centre of the sphere in which test cases lie, three numbers"};
const Setting<double> kWorkspaceRadius{
    "radius_m", {.lower = 1e-3, .upper = 100}, WorkspaceSphere{}.radius_m, "radius of that sphere"};
const Setting<std::vector<double>> kWorkspaceNormal{
    "normal", kDirectionRange, kNoDefault,
    "test cases lie in the disc of the sphere across this direction, three numbers"};
const Setting<double> kWorkspaceShortestMove{
    "shortest_move_m",
    {.lower = 1e-6, .upper = 2 * WorkspaceSphere{}.radius_m},
    WorkspaceSphere{}.shortest_move_m,
    "shortest move between two points of a test case; at most twice the radius"};

namespace {

const Setting<std::string> kTaskSignal{
    "signal", signal_names, "complex",
    "how the target moves from point to point (armwright list signals)"};
const Setting<double> kTaskTrapezoidAcceleration{"trapezoid_acceleration_m_per_s2",
                                                 {.lower = 0, .upper = 1e6, .lower_open = true},
                                                 TrackingTask{}.trapezoid_acceleration_m_per_s2,
                                                 "acceleration of the signal trapezoid"};
const Setting<double> kTaskRest{
    "rest_s",
    {.lower = 0, .upper = 60},
    TrackingTask{}.rest_s,
    "how long the target rests after each move; the error counts during the rest"};
const Setting<bool> kTaskIkBug{"ik_bug", TrackingTask{}.ik_bug,
                               "whether to repeat the thesis's error in its inverse kinematics"};
const Setting<double> kTaskLoad{
    "load_kg", {.lower = 0, .upper = 1000}, TrackingTask{}.load_kg, "mass of the load"};
const Setting<std::vector<double>> kTaskLoadInertia{
    "load_inertia_kg_m2",
    {.lower = -1e6, .upper = 1e6},
    kNoDefault,
    "the load's inertia about its centre of mass in the tip's axes: ixx, iyy, izz, ixy, ixz and "
    "iyz; needs load_com_m (default: a point mass)"};
const Setting<std::string> kTaskKinematics{
    "kinematics", kinematics_names, "auto",
    "inverse kinematics; auto: the closed form if the arm is a palletiser, else numeric"};
const Setting<std::string> kTaskSolver{
    "solver", numeric_solver_names, "lanes",
    "how numeric inverse kinematics is computed; lanes: many times as fast; scalar: to the last "
    "bit as in version 1.0, whose recorded configurations lack this key"};
const Setting<double> kTaskOrientationArm{
    "orientation_arm_m",
    {.lower = 1e-3, .upper = 100},
    ToolTask{}.arm_m,
    "position error that an orientation error of 1 rad counts as"};

const Setting<std::string> kControlStart{"start", control_start_names, "empty",
                                         "what the controllers' integrals hold when they are "
                                         "enabled; empty: nothing, so that the arm sags "
                                         "until they have filled, as in version 1.0; gravity: the "
                                         "nominal arm with its load in the first "
                                         "posture of each case (the problem robot has gravity)"};

const Setting<int> kWorkspacePoints{"points",
                                    {.lower = 3, .upper = 1000},
                                    WorkspaceSphere{}.points,
                                    "points of a test case, the one where it begins not counted"};

ToolTask read_tool(const ConfigTable& table) {
  ToolTask tool;
  tool.orientation = static_cast<ToolOrientation>(table.get_choice(kTaskOrientation));
  if (table.has(kTaskToolRpy)) {
    tool.turn = make_turn(read_vector(table, kTaskToolRpy, "roll, pitch and yaw in rad"));
  }
  if (table.has(kTaskToolAxis)) {
    tool.axis = read_direction(table, kTaskToolAxis);
  }
  tool.arm_m = table.get(kTaskOrientationArm);
  return tool;
}

// Returns the load's shape of the user's own, if the table has one.
std::optional<LoadBody> read_load_body(const ConfigTable& table, double load_kg) {
  const auto inertia = table.find(kTaskLoadInertia);
  if (!table.has(kTaskLoadCom)) {
    if (inertia) {
      table.refuse(kTaskLoadInertia, "it needs task.load_com_m, the load's centre of mass");
    }
    return std::nullopt;
  }
  LoadBody body;
  body.com_m = read_vector(table, kTaskLoadCom, "x, y and z in m, in the tip's frame");
  if (!inertia) {
    return body;
  }
  const std::vector<double>& i = *inertia;
  if (i.size() != 6) {
    table.refuse(kTaskLoadInertia, "it must be six numbers: ixx, iyy, izz, ixy, ixz and iyz");
  }
  if (load_kg == 0) {
    table.refuse(kTaskLoadInertia, "it needs task.load_kg > 0, the mass that it belongs to");
  }
  Eigen::Matrix3d tensor;
  tensor << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  const Eigen::Vector3d moments =  // ascending
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
  // The eigenvalues of a rod or a disc have rounding errors.
  const double rounding = 1e-12 * tensor.norm();
  if (moments[0] < -rounding || moments[2] > moments[0] + moments[1] + rounding) {
    table.refuse(
        kTaskLoadInertia,
        fmt::format("no body has its principal moments {:.6g}, {:.6g} and {:.6g}: none may "
                    "be negative, and the largest must not exceed the sum of the others",
                    moments[0], moments[1], moments[2]));
  }
  body.inertia_m2 = tensor / load_kg;
  return body;
}

}  // namespace

const SettingTable kTaskSettings{
    .key = "task",
    .settings = {
        &kTaskSignal,      &kTaskSpeed,           &kTaskDistanceLimit, &kTaskTrapezoidAcceleration,
        &kTaskRest,        &kTaskCountFirstPoint, &kTaskIkBug,         &kTaskLoad,
        &kTaskLoadCom,     &kTaskLoadInertia,     &kTaskKinematics,    &kTaskSolver,
        &kTaskLimits,      &kTaskFloor,           &kTaskClearance,     &kTaskSelfClearance,
        &kTaskOrientation, &kTaskToolRpy,         &kTaskToolAxis,      &kTaskOrientationArm,
        &kTaskHome}};
const SettingTable kControlSettings{
    .key = "control",
    .settings = {&kControlPeriod, &kControlController, &kControlStart, &kControlInterface,
                 &kControlBandwidth, &kControlDelay, &kControlResolution,
                 &kControlSlideResolution}};
const SettingTable kWorkspaceSettings{
    .key = "workspace",
    .settings = {&kWorkspaceCentre, &kWorkspaceRadius, &kWorkspaceNormal, &kWorkspaceShortestMove,
                 &kWorkspacePoints}};

Eigen::Vector3d read_vector(const ConfigTable& table, const Setting<std::vector<double>>& setting,
                            std::string_view what) {
  const auto numbers = table.get(setting);
  if (numbers.size() != 3) {
    table.refuse(setting, fmt::format("it must be three numbers: {}", what));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<double> read_per_joint(const ConfigTable& table,
                                   const Setting<std::vector<double>>& setting,
                                   std::size_t joints) {
  std::vector<double> values = table.get(setting);
  if (values.size() == 1) {
    values.resize(joints, values.front());
  }
  if (!values.empty() && values.size() != joints) {
    table.refuse(setting,
                 fmt::format("it must hold one number, or {}, one per joint of the robot", joints));
  }
  return values;
}

Eigen::Vector3d read_direction(const ConfigTable& table,
                               const Setting<std::vector<double>>& setting) {
  const Eigen::Vector3d vector = read_vector(table, setting, "a direction's x, y and z");
  if (!(vector.norm() > 1e-9)) {
    table.refuse(setting, "it must point somewhere: one of the three numbers must not be 0");
  }
  return vector.normalized();
}

TrackingTask read_task(const ConfigTable& table, const ConfigTable& control) {
  TrackingTask task;
  task.signal = find_signal(table.get(kTaskSignal));
  task.speed_m_per_s = table.get(kTaskSpeed);
  task.distance_limit_m = table.get(kTaskDistanceLimit);
  task.trapezoid_acceleration_m_per_s2 = table.get(kTaskTrapezoidAcceleration);
  task.rest_s = table.get(kTaskRest);
  task.count_first_point = table.get(kTaskCountFirstPoint);
  task.ik_bug = table.get(kTaskIkBug);
  task.load_kg = table.get(kTaskLoad);
  task.load_body = read_load_body(table, task.load_kg);
  task.kinematics = static_cast<KinematicsChoice>(table.get_choice(kTaskKinematics));
  task.solver = static_cast<NumericSolver>(table.get_choice(kTaskSolver));
  task.limits = static_cast<LimitPolicy>(table.get_choice(kTaskLimits));
  task.floor_m = table.find(kTaskFloor);
  task.tool = read_tool(table);
  if (const auto home = table.find(kTaskHome)) {
    task.home = *home;
  }
  if (task.kinematics == KinematicsChoice::palletiser &&
      task.tool.orientation != ToolOrientation::free) {
    table.refuse(kTaskKinematics,
                 "the closed form of a palletiser says nothing of the tool's orientation; set "
                 "task.orientation to \"free\" or kinematics to \"numeric\"");
  }
  task.control_period_s = control.get(kControlPeriod);
  task.control_start = static_cast<ControlStart>(control.get_choice(kControlStart));
  if (task.control_start == ControlStart::empty) {
    control.leave_out(kControlStart);  // so recorded version 1.0
  }
  return task;
}

void settle_solver(const ConfigTable& table, const TrackingSetup& setup) {
  if (setup.has_closed_form() || setup.task().solver == NumericSolver::scalar) {
    table.leave_out(kTaskSolver);  // so recorded version 1.0
  } else {
    table.settle(kTaskSolver,
                 numeric_solver_names()[static_cast<std::size_t>(setup.task().solver)]);
  }
}

WorkspaceSphere read_workspace(const ConfigTable& table) {
  WorkspaceSphere sphere;
  if (table.has(kWorkspaceCentre)) {
    sphere.centre_m = read_vector(table, kWorkspaceCentre, "x, y and z in metres");
  }
  if (table.has(kWorkspaceNormal)) {
    sphere.normal = read_direction(table, kWorkspaceNormal);
  }
  sphere.radius_m = table.get(kWorkspaceRadius);
  sphere.shortest_move_m = table.get(kWorkspaceShortestMove.within(
      {.lower = kWorkspaceShortestMove.range.lower, .upper = 2 * sphere.radius_m}));
  sphere.points = table.get(kWorkspacePoints);
  try {
    TestSet::make_generated("test/1", sphere);
  } catch (const Error& error) {
    table.refuse(
        table.has(kWorkspaceShortestMove) ? kWorkspaceShortestMove.key : kWorkspaceRadius.key,
        error.what());
  }
  return sphere;
}

void check_length(const ConfigTable& table, const ConfigTable& control,
                  const TrackingConfig& config) {
  const double periods = calc_case_duration_s(config, config.task) / config.task.control_period_s;
  if (periods > kMostPeriods) {
    const std::string must = fmt::format(
        "a test case would take {:.3g} control periods, possible are {:.3g}; raise "
        "control.period_s or task.speed_m_per_s, or lower task.distance_limit_m, "
        "task.rest_s or workspace.points",
        periods, kMostPeriods);
    if (control.has(kControlPeriod)) {
      control.refuse(kControlPeriod, must);
    }
    table.refuse(kTaskSpeed, must);
  }
}

}  // namespace armwright
