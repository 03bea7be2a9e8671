// Reads problems of the kind motion: [motion] and its points.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/motion/motion_problem.hpp"
#include "sim/dynamics/arm_equations.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr Range kLimitRange{.lower = 0, .upper = 1e9, .lower_open = true};
constexpr Range kJointPlace{.lower = -1000, .upper = 1000};

const Setting<std::string> kCurve{
    "curve", curve_kind_names, "cubic",
    "for the kind motion: cubic or quintic splines through the points; rest: the arm rests at each "
    "point; line: so it does, and the tip moves straight between them in the least time"};
const Setting<std::string> kEnds{
    "ends", spline_ends_names, "rest",
    "of cubic splines: rest (no speed and no acceleration at the ends, with two virtual knots) or "
    "clamped (no speed)"};
const Setting<std::string> kProfile{
    "profile", rest_profile_names, "quintic",
    "for the curve rest: the polynomials of degree 5 and 7, or the jerk as four constant pieces or "
    "two sines"};
const Setting<std::vector<double>> kIntervals{
    "intervals_s", Range{.lower = 1e-4, .upper = 1e4}, std::vector<double>{},
    "times between the knots, which are then no variables (default: they are variables)"};
const Setting<double> kShortestInterval{"shortest_interval_s",
                                        {.lower = 1e-4, .upper = 1e4},
                                        MotionConfig{}.interval_s.lower,
                                        "least value of an interval"};
const Setting<double> kLongestInterval{"longest_interval_s",
                                       {.lower = 1e-4, .upper = 1e4},
                                       MotionConfig{}.interval_s.upper,
                                       "largest value of an interval"};
const Setting<int> kMotionSamples{
    "samples",
    {.lower = 11, .upper = 100'000},
    static_cast<int>(MotionConfig{}.samples),
    "even times at which efforts, clearance and the tool's speed are computed"};
const Setting<std::vector<double>> kMotionHome{
    "home", kJointPlace, std::vector<double>{},
    "joint positions at which the search for a tool's pose begins (default: the point before, or "
    "the middles of the ranges)"};
const Setting<bool> kRangeLimit{"range_limits", MotionConfig{}.limits_range,
                                "whether the joints' ranges are limits"};
const Setting<bool> kRobotLimits{"robot_limits", true,
                                 "whether the speeds and efforts of the robot's file are limits "
                                 "where the lists below give none"};
const Setting<std::vector<double>> kSpeedLimits{
    "speed_limits", kLimitRange, std::vector<double>{},
    "largest rates, rad/s or m/s: one number, or one per joint"};
const Setting<std::vector<double>> kAccelerationLimits{
    "acceleration_limits", kLimitRange, std::vector<double>{},
    "largest accelerations, rad/s^2 or m/s^2, in the same way (default: none)"};
const Setting<std::vector<double>> kJerkLimits{
    "jerk_limits", kLimitRange, std::vector<double>{},
    "largest jerks, rad/s^3 or m/s^3, in the same way (default: none)"};
const Setting<std::vector<double>> kEffortLimits{"effort_limits", kLimitRange,
                                                 std::vector<double>{},
                                                 "largest efforts, N m or N, in the same way"};
const Setting<std::vector<double>> kEffortShareBounds{
    "effort_share_bounds", Range{.lower = 1e-3, .upper = 1}, kNoDefault,
    "for the curve line: least and largest share of its effort limit that a joint may use, which "
    "is a variable (default: 0.1 and 1)"};
const Setting<double> kToolSpeedLimit{"tool_speed_limit_m_per_s", kLimitRange, kNoDefault,
                                      "largest speed of the tip (default: none)"};
const Setting<double> kLeastClearance{
    "clearance_m",
    {.lower = 0, .upper = 10},
    kNoDefault,
    "least distance of the links from obstacles, and from each other (default: no limit)"};
const Setting<bool> kSelfClearance{
    "self_clearance", false, "whether links must stay clear of each other and of the base too"};

const Setting<std::vector<double>> kPointJoints{
    "joints", kJointPlace, kNoDefault, "joint positions at the point, rad or m, one per joint"};
const Setting<std::vector<double>> kPointTool{
    "tool_m", kCellPlace, kNoDefault, "position of the tip at the point: x, y and z in the world"};
const Setting<std::vector<double>> kPointToolRpy{
    "tool_rpy_rad", kAngleRange, kNoDefault,
    "the tool's orientation there: roll, pitch and yaw (default: free)"};
const Setting<std::string> kPointFile{"file", kNoDefault,
                                      "joint positions of one or more points: a motion.csv or "
                                      "JointTrajectory, looked for beside this file; its times "
                                      "do not count"};
const Setting<bool> kPointFree{"free", false,
                               "whether the joint positions of the point are variables"};
const SettingTable kMotionPointSettings{
    .key = "point",
    .is_array = true,
    .settings = {&kPointJoints, &kPointTool, &kPointToolRpy, &kPointFile, &kPointFree}};

constexpr std::size_t kMostFilePoints = 200;

// Returns the key that gives the joint positions of a point.
const std::string& get_joints_key(const ConfigTable& table) {
  return table.has(kPointFile) ? kPointFile.key : kPointJoints.key;
}

std::vector<MotionPoint> read_point_file(const ConfigTable& table, const RobotModel& robot,
                                         LoadedProblem& loaded) {
  const std::filesystem::path file = find_beside(table, kPointFile);
  const MotionSamples samples = read_motion_file(file, robot, false);
  if (samples.times_s.size() > kMostFilePoints) {
    table.refuse(kPointFile,
                 fmt::format("it has {} points, and a motion has {} at most; leave out points",
                             samples.times_s.size(), kMostFilePoints));
  }
  add_input(loaded, file);
  std::vector<MotionPoint> points;
  for (Eigen::Index k = 0; k < samples.positions.rows(); ++k) {
    points.emplace_back().q = samples.positions.row(k).transpose();
  }
  return points;
}

MotionPoint read_point(const ConfigTable& table, const RobotModel& robot) {
  MotionPoint point;
  const bool is_free = table.get(kPointFree);
  const auto joints = table.find(kPointJoints);
  if (joints.has_value() + table.has(kPointTool) + is_free != 1) {
    table.refuse(joints                  ? kPointJoints.key
                 : table.has(kPointTool) ? kPointTool.key
                                         : "point",
                 "a point has exactly one of joints, tool_m, file and free = true");
  }
  if (table.has(kPointToolRpy) && !table.has(kPointTool)) {
    table.refuse(kPointToolRpy, "it needs tool_m beside it");
  }
  if (joints) {
    if (joints->size() != robot.joint_count()) {
      table.refuse(kPointJoints,
                   fmt::format("it must hold {} numbers, one per joint", robot.joint_count()));
    }
    point.q = Eigen::Map<const Eigen::VectorXd>(joints->data(),
                                                static_cast<Eigen::Index>(joints->size()));
  } else if (!is_free) {
    ToolPose pose;
    pose.position_m = read_vector(table, kPointTool, "x, y and z in metres");
    if (table.has(kPointToolRpy)) {
      pose.turn = make_turn(read_vector(table, kPointToolRpy, "roll, pitch and yaw in rad"));
      point.has_turn = true;
    }
    point.tool = pose;
  }
  return point;
}

// Refuses points that lie outside of the joints' ranges, and equal neighbours.
void check_points(const ConfigTable& its, const std::vector<ConfigTable>& tables,
                  const MotionConfig& config) {
  const auto count = config.points.size();
  if (count < 2) {
    its.refuse(kMotionPointSettings.key,
               "a motion needs two [[motion.point]] tables or more, the start first");
  }
  const auto is_free = [&](std::size_t k) { return !config.points[k].q && !config.points[k].tool; };
  for (const std::size_t end : {std::size_t{0}, count - 1}) {
    if (is_free(end)) {
      tables[end].refuse(kPointFree, "the first and the last point cannot be free");
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto& q = config.points[k].q;
    if (!q) {
      continue;
    }
    for (std::size_t i = 0; i < config.robot.joint_count(); ++i) {
      const Joint& joint = config.robot.joints[i];
      const double value = (*q)[static_cast<Eigen::Index>(i)];
      if (config.limits_range && (value < joint.lower || value > joint.upper)) {
        tables[k].refuse(
            get_joints_key(tables[k]),
            fmt::format("point {}: joint '{}' is at {:g}, its range is {:g} to {:g}; move the "
                        "point, or set motion.range_limits = false",
                        k + 1, sanitize(joint.name), value, joint.lower, joint.upper));
      }
    }
    if (k > 0 && config.points[k - 1].q && *config.points[k - 1].q == *q) {
      tables[k].refuse(get_joints_key(tables[k]),
                       fmt::format("point {} is the same as point {}; leave one out", k + 1, k));
    }
  }
}

// Refuses what a straight line of the tool cannot have.
void check_line(const ConfigTable& its, const std::vector<ConfigTable>& tables,
                const MotionConfig& config) {
  for (std::size_t k = 0; k < config.points.size(); ++k) {
    const auto& tool = config.points[k].tool;
    if (!tool) {
      tables[k].refuse(kMotionPointSettings.key,
                       fmt::format("point {}: a line goes from one tool_m to the next; give the "
                                   "point by tool_m",
                                   k + 1));
    }
    const double way_m =
        k == 0 ? 1 : (tool->position_m - config.points[k - 1].tool->position_m).norm();
    if (way_m == 0) {
      tables[k].refuse(kPointTool,
                       fmt::format("point {} is the same as point {}; leave one out", k + 1, k));
    }
  }
  for (const auto* setting : {&kJerkLimits, &kIntervals}) {
    if (its.has(*setting)) {
      its.refuse(*setting,
                 "the line is timed by its limits on efforts, speeds and accelerations, and its "
                 "jerk has no bound; leave this out");
    }
  }
  for (std::size_t i = 0; i < config.limits.effort.size(); ++i) {
    if (!std::isfinite(config.limits.effort[i])) {
      its.refuse(kEffortLimits,
                 fmt::format("joint '{}' has no limit, and the line is timed by them; give "
                             "motion.effort_limits",
                             sanitize(config.robot.joints[i].name)));
    }
  }
}

// Refuses points at which the motors cannot hold the arm: no speed helps there.
void check_holding(const std::vector<ConfigTable>& tables, const MotionConfig& config) {
  if (!config.tubes.tubes.empty()) {
    return;  // the arm is a variable
  }
  const articulated::ChainModel chain(config.robot, config.gravity_m_per_s2);
  articulated::ArmEquations equations(chain);
  for (std::size_t k = 0; k < config.points.size(); ++k) {
    if (!config.points[k].q) {
      continue;
    }
    const Eigen::VectorXd& q = *config.points[k].q;
    const std::vector<double> efforts = equations.calc_holding_efforts(
        config.robot, {q.data(), static_cast<std::size_t>(q.size())});
    for (std::size_t i = 0; i < efforts.size(); ++i) {
      const Joint& joint = config.robot.joints[i];
      if (std::abs(efforts[i]) > config.limits.effort[i]) {
        tables[k].refuse(get_joints_key(tables[k]),
                         fmt::format("point {}: joint '{}' needs {:.4g} {} to hold the arm at rest "
                                     "there, its limit is {:.4g}; no motion can pass this point",
                                     k + 1, sanitize(joint.name), std::abs(efforts[i]),
                                     get_effort_unit(joint.kind), config.limits.effort[i]));
      }
    }
  }
}

void check_start(const std::vector<ConfigTable>& tables, const MotionConfig& config) {
  for (std::size_t k = 0; config.clearance && k < config.points.size(); ++k) {
    if (!config.points[k].q) {
      continue;
    }
    const Eigen::VectorXd& q = *config.points[k].q;
    const auto nearest = config.clearance->find_nearest(
        calc_link_poses(config.robot, {q.data(), static_cast<std::size_t>(q.size())}));
    const double least_m = config.least_clearance_m.value_or(0);
    if (nearest.distance_m < least_m) {
      tables[k].refuse(get_joints_key(tables[k]),
                       fmt::format("point {}: {}; move the point or the obstacle", k + 1,
                                   config.clearance->describe_gap(nearest, least_m)));
    }
  }
}

void read_motion_objective(const ConfigTable& table, MotionConfig& config) {
  config.is_front = table.get_or(kObjectiveKind.among({"sum", "front"}), "sum") == "front";
  config.objective = read_quantities(table, table.get_or(kObjectiveQuantities, {"duration"}),
                                     motion_quantity_names(), config.is_front);
  for (const WeightedQuantity& term : config.objective) {
    const auto quantity = static_cast<MotionQuantity>(term.quantity);
    if (quantity == MotionQuantity::clearance && !config.clearance) {
      table.refuse(kObjectiveQuantities,
                   "there is nothing to be clear of; add an [[obstacle]], or set "
                   "motion.self_clearance = true");
    }
    if (quantity == MotionQuantity::jerk && config.form.kind == CurveKind::line) {
      table.refuse(kObjectiveQuantities, "the jerk of a line has no bound; leave it out");
    }
    if (quantity == MotionQuantity::deflection && config.tubes.tubes.empty()) {
      table.refuse(kObjectiveQuantities, "only arms of [tubes] have a deflection");
    }
  }
}

}  // namespace

const SettingTable kMotionSettings{.key = "motion",
                                   .settings = {&kCurve,
                                                &kEnds,
                                                &kProfile,
                                                &kIntervals,
                                                &kShortestInterval,
                                                &kLongestInterval,
                                                &kMotionSamples,
                                                &kMotionHome,
                                                &kRangeLimit,
                                                &kRobotLimits,
                                                &kSpeedLimits,
                                                &kAccelerationLimits,
                                                &kJerkLimits,
                                                &kEffortLimits,
                                                &kEffortShareBounds,
                                                &kToolSpeedLimit,
                                                &kLeastClearance,
                                                &kSelfClearance,
                                                &kPayloadMass,
                                                &kPayloadCom},
                                   .tables = {&kMotionPointSettings}};

void load_motion(const ConfigTable& table, LoadedProblem& loaded) {
  MotionConfig config;
  config.name = loaded.name;
  config.summary = loaded.title;
  const ConfigTable robot = table.get_table(kRobotSettings);
  const std::filesystem::path urdf = resolve_named(robot, kRobotUrdf, "robots");
  config.robot = read_robot(robot, loaded).robot;
  const std::size_t joints = config.robot.joint_count();
  const ConfigTable its = table.get_table(kMotionSettings);
  read_payload(its, config.robot);
  config.gravity_m_per_s2 =
      read_physics(table.get_table_or_empty(kPhysicsSettings)).gravity_m_per_s2;
  config.form.kind = static_cast<CurveKind>(its.get_choice(kCurve));
  config.form.ends = static_cast<SplineEnds>(its.get_choice(kEnds));
  config.form.profile = static_cast<RestProfile>(its.get_choice(kProfile));
  config.home = its.get(kMotionHome);
  if (!config.home.empty() && config.home.size() != joints) {
    its.refuse(kMotionHome, fmt::format("it must hold {} numbers, one per joint", joints));
  }
  config.samples = static_cast<std::size_t>(its.get(kMotionSamples));
  config.limits_range = its.get(kRangeLimit);
  const std::vector<double> unlimited(joints, kUnlimited);
  std::vector<double> speeds = unlimited, efforts = unlimited;
  for (std::size_t i = 0; its.get(kRobotLimits) && i < joints; ++i) {
    // A limit of 0 in a URDF stands for one that its author did not know.
    const Joint& joint = config.robot.joints[i];
    speeds[i] = joint.speed_limit > 0 ? joint.speed_limit : kUnlimited;
    efforts[i] = joint.effort_limit > 0 ? joint.effort_limit : kUnlimited;
  }
  const auto read_limits = [&](const Setting<std::vector<double>>& setting,
                               const std::vector<double>& otherwise) {
    const std::vector<double> values = read_per_joint(its, setting, joints);
    return values.empty() ? otherwise : values;
  };
  config.limits = {read_limits(kSpeedLimits, speeds), read_limits(kAccelerationLimits, unlimited),
                   read_limits(kJerkLimits, unlimited), read_limits(kEffortLimits, efforts)};
  config.tool_speed_limit_m_per_s = its.find(kToolSpeedLimit);
  config.least_clearance_m = its.find(kLeastClearance);
  if (config.form.kind == CurveKind::line) {
    config.effort_share = read_bounds(its, kEffortShareBounds).value_or(config.effort_share);
  }
  std::vector<ConfigTable> points;  // the table that gives each point
  for (const ConfigTable& table_of : its.get_tables_or_empty(kMotionPointSettings)) {
    const std::vector<MotionPoint> read = table_of.has(kPointFile)
                                              ? read_point_file(table_of, config.robot, loaded)
                                              : std::vector{read_point(table_of, config.robot)};
    config.points.insert(config.points.end(), read.begin(), read.end());
    points.insert(points.end(), read.size(), table_of);
  }
  check_points(its, points, config);
  if (config.form.kind == CurveKind::line) {
    check_line(its, points, config);
  }
  config.intervals_s = its.get(kIntervals);
  const std::size_t intervals = config.form.count_intervals(config.points.size());
  if (!config.intervals_s.empty() && config.intervals_s.size() != intervals) {
    its.refuse(kIntervals,
               fmt::format("it must hold {} numbers, one per interval of this curve", intervals));
  }
  config.interval_s = {its.get(kShortestInterval), its.get(kLongestInterval)};
  if (config.interval_s.lower >= config.interval_s.upper) {
    its.refuse(kLongestInterval, fmt::format("it must be above motion.shortest_interval_s, {:g} s",
                                             config.interval_s.lower));
  }
  config.tubes = read_tubes(table, config.robot);
  config.clearance = read_clearance(table, urdf, its.get(kSelfClearance), config.robot, loaded);
  if (config.least_clearance_m && !config.clearance) {
    its.refuse(kLeastClearance,
               "there is nothing to be clear of; add an [[obstacle]], or set "
               "motion.self_clearance = true");
  }
  read_motion_objective(table.get_table_or_empty(kObjectiveSettings), config);
  check_holding(points, config);
  check_start(points, config);
  name_robot_file(urdf,
                  [&] { loaded.problem = std::make_shared<MotionProblem>(std::move(config)); });
}

}  // namespace armwright
