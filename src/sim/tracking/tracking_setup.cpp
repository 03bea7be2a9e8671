#include "sim/tracking/tracking_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/read_limit.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/simd/simd_level.hpp"
#include "sim/tracking/path_check.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

// Tolerance for times that are multiples of the control period up to rounding: t_m + rest = 1.1 s
// is 110 periods of 0.01 s, not 111.
constexpr double kTimeTolerance = 1e-9;  // in control periods

int calc_steps_covering(double duration_s, double period_s) {
  return static_cast<int>(std::ceil(duration_s / period_s - kTimeTolerance));
}

// Returns how many of a segment's steps end before the target has arrived, without any tolerance.
int count_moving_steps(const Segment& segment, double period_s) {
  int steps = segment.window_start;
  while ((steps + 1) * period_s < segment.duration_s) {
    ++steps;
  }
  while (steps > 0 && steps * period_s >= segment.duration_s) {
    --steps;
  }
  return steps;
}

constexpr int kJoints = 4;  // of an arm that the closed form can solve

// The rate at which joints move towards the middle of their ranges if the task leaves them free. It
// is slow compared with moves, which take about a second.
constexpr double kCentringRate_hz = 0.5;
// The steps between two looks at the limit of reading.
constexpr int kStepsBetweenLooks = 256;

// Copies the row before `begin` into all rows from `begin` to `end`.
void repeat_row(double* begin, const double* end) {
  if (begin == end) {
    return;
  }
  const double a = begin[-4];
  const double b = begin[-3];
  const double c = begin[-2];
  const double d = begin[-1];
  for (; begin != end; begin += kJoints) {
    begin[0] = a;
    begin[1] = b;
    begin[2] = c;
    begin[3] = d;
  }
}

}  // namespace

std::size_t TargetTable::size_bytes() const {
  return sizeof *this + segments.size() * sizeof(Segment) +
         (start_positions.size() + joint_positions.size() + feed_forward_effort.size()) *
             sizeof(double) +
         tool_points_m.size() * sizeof(Eigen::Vector3d) + unreachable.size();
}

const std::vector<std::string>& kinematics_names() {
  static const std::vector<std::string> names = {"auto", "palletiser", "numeric"};
  return names;
}

const std::vector<std::string>& limit_policy_names() {
  static const std::vector<std::string> names = {"ignore", "warn", "enforce"};
  return names;
}

TrackingSetup::TrackingSetup(const RobotModel& robot, const TrackingTask& task)
    : robot_(task.load_kg > 0 ? add_load(robot, task.load_kg, task.load_body) : robot),
      task_(task),
      tool_points_m_(make_tool_points(task.tool)) {
  const bool may_have_closed_form = task.kinematics != KinematicsChoice::numeric &&
                                    task.tool.orientation == ToolOrientation::free;
  if (task.kinematics == KinematicsChoice::palletiser) {
    closed_form_.emplace(robot, task.ik_bug);
  } else if (may_have_closed_form) {
    closed_form_ = ElbowUpKinematics::make_if_suited(robot, task.ik_bug);
  }
  for (const Eigen::Vector3d& point_m : tool_points_m_) {
    robot_.tool_points_m.push_back(robot_.tip_pose * point_m);
  }
  if (!closed_form_) {
    numeric_ = get_kinematics();
    numeric_->check_task(robot_);
  }
  chain_ = std::make_shared<articulated::ChainModel>(robot_, task.physics.gravity_m_per_s2);
}

std::shared_ptr<const NumericKinematics> TrackingSetup::get_kinematics() const {
  if (numeric_) {
    return numeric_;
  }
  ToolTask tool = task_.tool;
  if (closed_form_) {  // the closed form keeps the last link, which ends in the tip, pointing down
    tool.orientation = ToolOrientation::pointing;
    tool.axis = robot_.tip_pose.linear().transpose() * robot_.tip_pose.translation().normalized();
  }
  return std::make_shared<NumericKinematics>(robot_, tool, task_.home,
                                             task_.limits != LimitPolicy::ignore);
}

targets::SignalCurve TrackingSetup::make_signal(double distance_m) const {
  double speed = task_.speed_m_per_s;
  if (distance_m < task_.distance_limit_m) {
    speed *= distance_m / task_.distance_limit_m;
  }
  return make_signal_curve(task_.signal, distance_m, speed, task_.trapezoid_acceleration_m_per_s2);
}

targets::Move TrackingSetup::make_move(const Segment& segment) const {
  targets::Move move;
  const Eigen::Vector3d way = segment.to_m - segment.from_m;
  Eigen::Vector3d::Map(move.from_m) = segment.from_m;
  Eigen::Vector3d::Map(move.to_m) = segment.to_m;
  Eigen::Vector3d::Map(move.way_m) = way;
  move.curve = make_signal(way.norm());
  move.period_s = task_.control_period_s;
  return move;
}

Eigen::Vector3d TrackingSetup::calc_target_position(const Segment& segment,
                                                    int step_in_segment) const {
  if (segment.is_sample) {
    return segment.to_m;
  }
  Eigen::Vector3d position;
  targets::calc_position(make_move(segment), step_in_segment, position.data());
  return position;
}

ToolPose TrackingSetup::make_pose(const TestCase& test_case, std::size_t point) const {
  return {test_case.points_m[point],
          test_case.turns.empty() ? task_.tool.turn : test_case.turns[point].toRotationMatrix()};
}

ToolPose TrackingSetup::calc_target_pose(const TestCase& test_case, const TargetTable& table,
                                         std::size_t segment, int step) const {
  const Segment& its = table.segments[segment];
  ToolPose pose = make_pose(test_case, segment + 1);
  pose.position_m = calc_target_position(its, step);
  const double time_s = (step + 1) * task_.control_period_s;
  if (!its.is_sample && !test_case.turns.empty() && time_s < its.duration_s) {
    // The tool turns in proportion to the distance covered (Shoemake 1985, Animating rotation with
    // quaternion curves, SIGGRAPH 19).
    const double distance_m = (its.to_m - its.from_m).norm();
    const double share = targets::calc_distance(make_signal(distance_m), time_s) / distance_m;
    pose.turn =
        test_case.turns[segment].slerp(share, test_case.turns[segment + 1]).toRotationMatrix();
  }
  return pose;
}

int TrackingSetup::count_distinct_steps(const Segment& segment) const {
  return std::min(segment.steps, count_moving_steps(segment, task_.control_period_s) + 1);
}

void TrackingSetup::make_timeline(const TestCase& test_case, TargetTable& table) const {
  const double period = task_.control_period_s;
  for (std::size_t k = 1; k < test_case.points_m.size(); ++k) {
    Segment segment;
    segment.from_m = test_case.points_m[k - 1];
    segment.to_m = test_case.points_m[k];
    segment.first_step = table.steps;
    if (test_case.continuous) {
      segment.is_sample = true;
      segment.duration_s = period;
      segment.steps = 1;
    } else {
      const double distance = (segment.to_m - segment.from_m).norm();
      segment.duration_s = make_signal(distance).duration_s;
      segment.steps = calc_steps_covering(segment.duration_s + task_.rest_s, period);
      segment.window_start = std::max(0, calc_steps_covering(segment.duration_s, period) - 1);
    }
    table.steps += segment.steps;
    table.segments.push_back(segment);
    const ToolPose end = make_pose(test_case, k);
    for (const Eigen::Vector3d& point_m : tool_points_m_) {
      table.tool_points_m.emplace_back(end.position_m + end.turn * point_m);
    }
  }
}

void TrackingSetup::solve_closed_form(const TestCase& test_case, TargetTable& table) const {
  std::array<double, kJoints> q{};
  const Eigen::Vector3d& start = test_case.points_m.front();
  if (!closed_form_->solve(start, q)) {
    table.unreachable = "start: " + closed_form_->describe_unreachable(start);
    return;
  }
  table.start_positions.assign(q.begin(), q.end());
  table.joint_positions.resize(static_cast<std::size_t>(table.steps) * table.joints);
  const targets::SolveMove solve_move = targets::get_solve_move(find_best_simd());
  for (std::size_t k = 0; k < table.segments.size(); ++k) {
    const Segment& segment = table.segments[k];
    const std::size_t first = static_cast<std::size_t>(segment.first_step) * table.joints;
    double* const angles = table.joint_positions.data() + first;
    // After its arrival the target stays, and so do the joint positions.
    const int distinct = count_distinct_steps(segment);
    int reached = 0;
    if (segment.is_sample) {
      reached = closed_form_->solve(segment.to_m, std::span<double, kJoints>(angles, kJoints));
    } else {
      reached = solve_move(closed_form_->arm(), make_move(segment), distinct, angles);
    }
    if (reached < distinct) {
      table.unreachable =
          fmt::format("on the way to point {}: {}", k + 1,
                      closed_form_->describe_unreachable(calc_target_position(segment, reached)));
      table.joint_positions.resize(first + static_cast<std::size_t>(reached) * table.joints);
      return;
    }
    repeat_row(angles + distinct * kJoints, angles + segment.steps * kJoints);
  }
}

void TrackingSetup::solve_numerically(const TestCase& test_case, TargetTable& table) const {
  const std::size_t n = table.joints;
  std::vector<double> q(n);
  const auto describe = [&](const ToolPose& pose, const std::vector<double>& ended) {
    return describe_unreachable(*numeric_, robot_, task_.tool, pose, ended);
  };
  const ToolPose start = make_pose(test_case, 0);
  if (!numeric_->find(start, q)) {
    table.unreachable = "start: " + describe(start, q);
    return;
  }
  table.start_positions = q;
  table.joint_positions.resize(static_cast<std::size_t>(table.steps) * n);
  std::vector<double> before = q;  // a step earlier
  std::vector<double> wish(n);
  const double centring = std::min(1.0, kCentringRate_hz * task_.control_period_s);
  for (std::size_t k = 0; k < table.segments.size(); ++k) {
    const Segment& segment = table.segments[k];
    const int distinct = count_distinct_steps(segment);
    for (int step = 0; step < segment.steps; ++step) {
      double* const row =
          table.joint_positions.data() + static_cast<std::size_t>(segment.first_step + step) * n;
      if (step < distinct) {
        // The search starts where the joints would be at their present speed, so it needs only one
        // or two iterations. Motion that the task leaves free goes towards the middle of the
        // ranges.
        if (step % kStepsBetweenLooks == 0) {
          check_reading();
        }
        for (std::size_t i = 0; i < n; ++i) {
          const double carried = q[i] - before[i];
          const double drawn =
              numeric_->has_middle(i) ? centring * (numeric_->get_middle(i) - q[i]) : 0;
          before[i] = q[i];
          q[i] += carried;
          wish[i] = drawn - carried;
        }
        const ToolPose pose = calc_target_pose(test_case, table, k, step);
        const std::vector<double> from = before;
        if (!numeric_->follow(pose, wish, q)) {
          table.unreachable =
              fmt::format("on the way to point {}: {}", k + 1, describe(pose, from));
          table.joint_positions.resize(
              static_cast<std::size_t>(row - table.joint_positions.data()));
          return;
        }
      } else {
        before = q;
      }
      std::copy(q.begin(), q.end(), row);
    }
  }
}

TargetTable TrackingSetup::make_targets(const TestCase& test_case) const {
  TargetTable table;
  table.joints = robot_.joint_count();
  make_timeline(test_case, table);
  if (closed_form_) {
    solve_closed_form(test_case, table);
  } else {
    solve_numerically(test_case, table);
  }
  if (!table.unreachable.empty()) {
    return table;
  }
  if (task_.limits == LimitPolicy::enforce) {
    const std::vector<PathFault> faults = find_path_faults(*this, table);
    if (!faults.empty()) {
      table.unreachable = describe(faults.front(), robot_);
      return table;
    }
  }
  fill_feed_forward(table);
  return table;
}

}  // namespace armwright
