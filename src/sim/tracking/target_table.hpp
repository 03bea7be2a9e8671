// The targets of one test case under one task. They are the same for every design, so they are
// computed once per case (tracking_setup.hpp).
//
// Timeline: segment k takes ceil((t_m + rest) / h) control periods, and its clock starts at 0. The
// controllers are not reset between segments. In each control period
//   - the setpoints are the joint positions of the moving target at the END of the period,
//   - the controllers compute efforts from the joint positions measured at its start,
//   - the plant takes `substeps` steps with the efforts held.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace armwright {

// One segment of the timeline: the target's move to one point, and the rest after it.
struct Segment {
  Eigen::Vector3d from_m, to_m;
  int first_step = 0;
  int steps = 0;
  int window_start = 0;   // first step (within the segment) whose end lies in the measuring window
  double duration_s = 0;  // t_m
  // True for a segment of a continuous path: a single step, at whose end the target is at `to_m`.
  bool is_sample = false;
};

// Positions are in rad and efforts in N m for a revolute joint, in m and N for a prismatic one.
struct TargetTable {
  std::vector<Segment> segments;
  std::size_t joints = 0;
  int steps = 0;
  std::vector<double> start_positions;  // one per joint; the arm starts there, at rest
  // The setpoints: steps x joints, row-major, one row per control period.
  std::vector<double> joint_positions;
  // Feed-forward efforts, laid out like joint_positions. They are computed for the arm of the setup
  // that made the table. Empty if the task has FeedForward::none.
  std::vector<double> feed_forward_effort;
  // The efforts, one per joint, with which the controllers begin: those that hold the same arm at rest
  // in the start positions. Empty if the task has ControlStart::empty.
  std::vector<double> holding_effort;
  // Positions of the robot's tool points at the end of each segment: one row per segment.
  std::vector<Eigen::Vector3d> tool_points_m;
  // Not empty if the case cannot be simulated: the reason. joint_positions then ends at the first
  // target that has no solution, or is complete if the path violates a limit.
  std::string unreachable;

  std::span<const double> positions(int step) const {
    return {joint_positions.data() + static_cast<std::size_t>(step) * joints, joints};
  }
  std::span<const double> feed_forward(int step) const {
    return {feed_forward_effort.data() + static_cast<std::size_t>(step) * joints, joints};
  }
  std::span<const Eigen::Vector3d> tool_points(std::size_t segment) const {
    const std::size_t points = tool_points_m.size() / segments.size();
    return std::span(tool_points_m).subspan(segment * points, points);
  }
  std::size_t size_bytes() const;
};

}  // namespace armwright
