#include "sim/tracking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "sim/articulated/chain_model.hpp"
#include "sim/articulated/feed_forward.hpp"
#include "sim/simd_level.hpp"

namespace armwright {
namespace {

// Times are multiples of the control period up to rounding: t_m + rest = 1.1 s is 110 periods of
// 0.01 s, not 111.
constexpr double kTimeTolerance = 1e-9;  // in control periods

int calc_steps_covering(double duration_s, double period_s) {
  return static_cast<int>(std::ceil(duration_s / period_s - kTimeTolerance));
}

// How many of a segment's steps end before the target has arrived, without any tolerance.
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

constexpr int kJoints = 4;  // of an arm that the kinematics can solve

// Fills whole rows from `begin` to `end` with the one before them, if there are any to fill.
void repeat_angles(double* begin, const double* end) {
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

double calc_largest_torque_n_m(const JointDrive& joint) {
  return std::max(-joint.limits.min_n_m, joint.limits.max_n_m);
}

double calc_total_torque_n_m(const ArmDesign& design) {
  double total = 0;
  for (const JointDrive& joint : design.joints) {
    total += calc_largest_torque_n_m(joint);
  }
  return total;
}

std::size_t TargetTable::size_bytes() const {
  return sizeof *this + segments.size() * sizeof(Segment) +
         (start_rad.size() + angles_rad.size() + feed_forward_n_m.size()) * sizeof(double) +
         unreachable.size();
}

const char* to_string(SimulationStatus status) {
  switch (status) {
    case SimulationStatus::ok:
      return "ok";
    case SimulationStatus::cut_off:
      return "cut_off";
    case SimulationStatus::diverged:
      return "diverged";
    case SimulationStatus::unreachable:
      return "unreachable";
    case SimulationStatus::abandoned:
      return "abandoned";
  }
  return "?";
}

TrackingSetup::TrackingSetup(const RobotModel& robot, const TrackingTask& task)
    : robot_(task.load_kg > 0 ? add_load(robot, task.load_kg) : robot),
      task_(task),
      kinematics_(robot, task.ik_bug),
      chain_(std::make_shared<articulated::ChainModel>(robot_, task.physics.gravity_m_per_s2)) {}

ReferenceSignal TrackingSetup::make_signal(double distance_m) const {
  double speed = task_.speed_m_per_s;
  if (distance_m < task_.distance_limit_m) {
    speed *= distance_m / task_.distance_limit_m;
  }
  return {task_.signal, distance_m, speed, task_.trapezoid_acceleration_m_per_s2};
}

targets::Move TrackingSetup::make_move(const Segment& segment) const {
  targets::Move move;
  const Eigen::Vector3d way = segment.to_m - segment.from_m;
  Eigen::Vector3d::Map(move.from_m) = segment.from_m;
  Eigen::Vector3d::Map(move.to_m) = segment.to_m;
  Eigen::Vector3d::Map(move.way_m) = way;
  move.curve = make_signal(way.norm()).curve();
  move.period_s = task_.control_period_s;
  return move;
}

Eigen::Vector3d TrackingSetup::calc_target_position(const Segment& segment,
                                                    int step_in_segment) const {
  Eigen::Vector3d position;
  targets::calc_position(make_move(segment), step_in_segment, position.data());
  return position;
}

TargetTable TrackingSetup::make_targets(const TestCase& test_case) const {
  TargetTable table;
  table.joints = robot_.joint_count();
  const double period = task_.control_period_s;
  for (std::size_t k = 1; k < test_case.points_m.size(); ++k) {
    Segment segment;
    segment.from_m = test_case.points_m[k - 1];
    segment.to_m = test_case.points_m[k];
    const double distance = (segment.to_m - segment.from_m).norm();
    segment.duration_s = make_signal(distance).duration_s();
    segment.first_step = table.steps;
    segment.steps = calc_steps_covering(segment.duration_s + task_.rest_s, period);
    segment.window_start = std::max(0, calc_steps_covering(segment.duration_s, period) - 1);
    table.steps += segment.steps;
    table.segments.push_back(segment);
  }

  std::array<double, kJoints> q{};
  const Eigen::Vector3d& start = test_case.points_m.front();
  if (!kinematics_.solve(start, q)) {
    table.unreachable = "start: " + kinematics_.describe_unreachable(start);
    return table;
  }
  table.start_rad.assign(q.begin(), q.end());
  table.angles_rad.resize(static_cast<std::size_t>(table.steps) * table.joints);
  const targets::SolveMove solve_move = targets::get_solve_move(find_best_simd());
  for (std::size_t k = 0; k < table.segments.size(); ++k) {
    const Segment& segment = table.segments[k];
    const std::size_t first = static_cast<std::size_t>(segment.first_step) * table.joints;
    double* const angles = table.angles_rad.data() + first;
    // Once arrived the target stays, and so do the angles.
    const int distinct = std::min(segment.steps, count_moving_steps(segment, period) + 1);
    const int reached = solve_move(kinematics_.arm(), make_move(segment), distinct, angles);
    if (reached < distinct) {
      table.unreachable =
          fmt::format("on the way to point {}: {}", k + 1,
                      kinematics_.describe_unreachable(calc_target_position(segment, reached)));
      table.angles_rad.resize(first + static_cast<std::size_t>(reached) * table.joints);
      return table;
    }
    repeat_angles(angles + distinct * kJoints, angles + segment.steps * kJoints);
  }
  articulated::fill_feed_forward(*chain_, task_.feed_forward, period, table);
  return table;
}

void check_feed_forward(const TrackingJob& job) {
  const ControllerRow& row = find_controller(job.design->controller);
  const TargetTable& targets = *job.targets;
  if (row.feed_forward != FeedForward::none && targets.unreachable.empty() &&
      targets.feed_forward_n_m.size() != targets.angles_rad.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("controller '{}' needs feed-forward efforts, which the targets of this "
                            "task do not come with; set control.controller to '{}'",
                            row.name, row.name));
  }
}

}  // namespace armwright
