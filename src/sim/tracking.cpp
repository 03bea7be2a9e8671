#include "sim/tracking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace armwright {
namespace {

// Times are multiples of the control period up to rounding: t_m + rest = 1.1 s is 110 periods of
// 0.01 s, not 111.
constexpr double kTimeTolerance = 1e-9;  // in control periods

int calc_steps_covering(double duration_s, double period_s) {
  return static_cast<int>(std::ceil(duration_s / period_s - kTimeTolerance));
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
         (start_rad.size() + angles_rad.size()) * sizeof(double) + unreachable.size();
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
      kinematics_(robot, task.ik_bug) {}

ReferenceSignal TrackingSetup::make_signal(double distance_m) const {
  double speed = task_.speed_m_per_s;
  if (distance_m < task_.distance_limit_m) {
    speed *= distance_m / task_.distance_limit_m;
  }
  return {task_.signal, distance_m, speed, task_.trapezoid_acceleration_m_per_s2};
}

Eigen::Vector3d TrackingSetup::calc_target_position(const Segment& segment,
                                                    int step_in_segment) const {
  const Eigen::Vector3d move = segment.to_m - segment.from_m;
  const double distance = move.norm();
  const double time = (step_in_segment + 1) * task_.control_period_s;
  if (time >= segment.duration_s) {
    return segment.to_m;  // the point itself, not the start plus a rounded move
  }
  return segment.from_m + move * (make_signal(distance).calc_distance(time) / distance);
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

  std::array<double, 4> q{};
  const Eigen::Vector3d& start = test_case.points_m.front();
  if (!kinematics_.solve(start, q)) {
    table.unreachable = "start: " + kinematics_.describe_unreachable(start);
    return table;
  }
  table.start_rad.assign(q.begin(), q.end());
  table.angles_rad.reserve(static_cast<std::size_t>(table.steps) * table.joints);
  for (std::size_t k = 0; k < table.segments.size(); ++k) {
    const Segment& segment = table.segments[k];
    for (int step = 0; step < segment.steps; ++step) {
      const Eigen::Vector3d target = calc_target_position(segment, step);
      if (!kinematics_.solve(target, q)) {
        table.unreachable = fmt::format("on the way to point {}: {}", k + 1,
                                        kinematics_.describe_unreachable(target));
        return table;
      }
      table.angles_rad.insert(table.angles_rad.end(), q.begin(), q.end());
    }
  }
  return table;
}

}  // namespace armwright
