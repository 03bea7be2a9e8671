// The robot with its load, together with the task: makes target tables and is what engines
// simulate.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/kinematics/kinematics.hpp"
#include "sim/kinematics/numeric_kinematics.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/target_table.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

namespace articulated {
class ChainModel;
}

// Immutable, so several threads may share one object.
class TrackingSetup {
 public:
  // Throws Error{usage} or Error{bad_data} if the chosen kinematics do not suit the robot.
  TrackingSetup(const RobotModel& robot, const TrackingTask& task);
  const RobotModel& robot() const { return robot_; }  // with the load
  const TrackingTask& task() const { return task_; }
  // Returns the robot's equations of motion. They belong to the setup because the feed-forward
  // efforts of target tables are computed from them. The engine `articulated` uses the same object.
  const articulated::ChainModel& chain() const { return *chain_; }
  // Returns the targets of a case. A case that cannot be simulated gives a table whose
  // `unreachable` says why. Throws Error{usage} if a move's reference signal cannot be made.
  TargetTable make_targets(const TestCase& test_case) const;
  // Returns the targets of several cases, with the same bits. Numeric kinematics are several times
  // as fast for postures::kLanes cases as for one.
  std::vector<TargetTable> make_targets(std::span<const TestCase> test_cases) const;
  // Returns the efforts (N m or N) that hold the robot at rest at joint positions q, without
  // friction.
  std::vector<double> calc_holding_efforts(std::span<const double> q) const;
  // Returns the target's position (m) at the end of a step, for error series and trajectories.
  Eigen::Vector3d calc_target_position(const Segment& segment, int step_in_segment) const;
  // Returns numeric kinematics of the robot, also if the task uses the closed form.
  std::shared_ptr<const NumericKinematics> get_kinematics() const;
  bool has_closed_form() const { return closed_form_.has_value(); }

 private:
  class NumericPath;  // the targets of one case, step by step

  targets::SignalCurve make_signal(double distance_m) const;
  targets::Move make_move(const Segment& segment) const;
  void make_timeline(const TestCase& test_case, TargetTable& table) const;
  void solve_closed_form(const TestCase& test_case, TargetTable& table) const;
  // Takes the joint positions that the case gives. The case must be continuous.
  void take_joints(const TestCase& test_case, TargetTable& table) const;
  // Solves the cases with these indices.
  void solve_numerically(std::span<const TestCase> test_cases,
                         std::span<const std::size_t> searched,
                         std::span<TargetTable> tables) const;
  // Computes the efforts that the task wants in the table, from its joint positions
  // (feed_forward.cpp).
  void fill_efforts(TargetTable& table) const;
  ToolPose make_pose(const TestCase& test_case, std::size_t point) const;
  // Returns how many of a segment's steps have targets of their own: the steps before the target
  // has arrived, and the first step at whose end it has.
  int count_distinct_steps(const Segment& segment) const;

  RobotModel robot_;
  TrackingTask task_;
  std::optional<ElbowUpKinematics> closed_form_;
  std::shared_ptr<const NumericKinematics> numeric_;  // null if there is a closed form
  std::vector<Eigen::Vector3d> tool_points_m_;        // from the tip, in its frame
  std::shared_ptr<const articulated::ChainModel> chain_;
};

}  // namespace armwright
