// The tracking task and what a simulation of it yields. Everything that is the same for every
// design on a test case (number of steps, target angles) is computed once, in a TargetTable;
// engines add the physics.
//
// Timeline: segment k takes ceil((t_m + rest) / h) control periods and its clock starts anew; the
// controllers are not reset between segments. In each period: target angles from the moving target
// at the END of the period, efforts from the angles at its start, then the plant is stepped
// `substeps` times with the effort held. The positional error of point k is the largest
// |tip - target| at the ends of periods from t_m to the end of the segment; a case's error is the
// mean over its points (from the second on, unless the first is counted).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/controllers/controller.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/kinematics/numeric_kinematics.hpp"
#include "sim/kinematics/tool_task.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/plant_variation.hpp"
#include "sim/tracking/reference_signal.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

namespace articulated {
class ChainModel;
}

struct PhysicsSettings {
  double gravity_m_per_s2 = 9.80665;
  int substeps =
      1;  // plant steps in a control period, the effort held. The published gains need exactly 1.
  double erp =
      0.25;  // ODE: share of a joint's position error corrected in a step (thesis: damping 1/25 s)
  double cfm = 0;  // ODE: constraint softness
};

// Which inverse kinematics: the closed form of a palletiser (kinematics.hpp), damped least squares
// (numeric_kinematics.hpp), or the first where the robot suits it and any orientation will do.
enum class KinematicsChoice { automatic, palletiser, numeric };
const std::vector<std::string>& kinematics_names();  // in the order of the enum

// What joint ranges, joint speeds and singularities mean for the target's path (path_check.hpp):
// nothing, as in the thesis; joints keep to their ranges; or a case that violates any cannot be
// simulated.
enum class LimitPolicy { ignore, warn, enforce };
const std::vector<std::string>& limit_policy_names();  // in the order of the enum

struct TrackingTask {
  SignalShape signal = SignalShape::complex;
  double speed_m_per_s = 1.5;     // v, nominal average speed
  double distance_limit_m = 0.9;  // shorter moves are slowed down by distance / limit; 0: none are
  double trapezoid_acceleration_m_per_s2 = 15;
  double rest_s = 0.5;
  double control_period_s = 0.01;  // h
  bool count_first_point = false;
  bool ik_bug = false;
  double load_kg = 0;
  KinematicsChoice kinematics = KinematicsChoice::automatic;
  LimitPolicy limits = LimitPolicy::ignore;
  ToolTask tool;
  std::vector<double> home;  // where numeric kinematics begin; empty: the middle of the ranges
  FeedForward feed_forward = FeedForward::none;  // what target tables hold beside the angles
  PhysicsSettings physics;
};

// What is designed: one controller and effort limits a joint; and, where they are not the robot's
// and the task's own, the links and the speed (sim/designed_arm.hpp).
struct JointDrive {
  std::vector<double> gains;  // in the order of the controller's GainSpecs
  EffortLimits limits;
  double length_scale = 1;  // of the link that the joint moves
  double section_scale = 1;
};
struct ArmDesign {
  std::string controller = "pid";
  std::vector<JointDrive> joints;
  std::optional<double> speed_m_per_s;  // nothing: the task's
};
// The larger of a joint's two limits, max(-min, max), and its sum over the joints: the thesis's
// total torque magnitude (N m).
double calc_largest_torque_n_m(const JointDrive& joint);
double calc_total_torque_n_m(const ArmDesign& design);

// One segment of the timeline.
struct Segment {
  Eigen::Vector3d from_m, to_m;
  int first_step = 0;
  int steps = 0;
  int window_start = 0;   // first step (within the segment) whose end lies in the measuring window
  double duration_s = 0;  // t_m
  // Of a continuous path: a single step at whose end the target is at `to_m`.
  bool is_sample = false;
};

// The targets of one test case under one task: the same for every design.
struct TargetTable {
  std::vector<Segment> segments;
  std::size_t joints = 0;
  int steps = 0;
  std::vector<double> start_rad;  // posture at rest at the beginning, one angle a joint
  std::vector<double>
      angles_rad;  // steps x joints, row-major: target at the end of each control period
  // As many, of the arm of the setup that made the table; empty if the task asks for none.
  std::vector<double> feed_forward_n_m;
  // Where the robot's tool points are to be at the end of each segment, as many as it has; a row a
  // segment.
  std::vector<Eigen::Vector3d> tool_points_m;
  std::string unreachable;  // not empty: no simulation is possible, and why

  std::span<const double> angles(int step) const {
    return {angles_rad.data() + static_cast<std::size_t>(step) * joints, joints};
  }
  std::span<const double> feed_forward(int step) const {
    return {feed_forward_n_m.data() + static_cast<std::size_t>(step) * joints, joints};
  }
  std::span<const Eigen::Vector3d> tool_points(std::size_t segment) const {
    const std::size_t points = tool_points_m.size() / segments.size();
    return std::span(tool_points_m).subspan(segment * points, points);
  }
  std::size_t size_bytes() const;
};

// The robot with its load and the task, ready to make target tables and to be simulated. Immutable.
class TrackingSetup {
 public:
  TrackingSetup(const RobotModel& robot, const TrackingTask& task);
  const RobotModel& robot() const { return robot_; }  // the load included
  const TrackingTask& task() const { return task_; }
  const articulated::ChainModel& chain() const { return *chain_; }  // the same robot
  TargetTable make_targets(const TestCase& test_case) const;
  // Where the target is at the end of a step: for error series and trajectories.
  Eigen::Vector3d calc_target_position(const Segment& segment, int step_in_segment) const;
  // How the robot's joints make its tool move, whichever kinematics the task has.
  std::shared_ptr<const NumericKinematics> get_kinematics() const;
  bool has_closed_form() const { return closed_form_.has_value(); }

 private:
  ReferenceSignal make_signal(double distance_m) const;
  targets::Move make_move(const Segment& segment) const;
  void make_timeline(const TestCase& test_case, TargetTable& table) const;
  void solve_closed_form(const TestCase& test_case, TargetTable& table) const;
  void solve_numerically(const TestCase& test_case, TargetTable& table) const;
  ToolPose make_pose(const TestCase& test_case, std::size_t point) const;
  // Like calc_target_position(), the turn included.
  ToolPose calc_target_pose(const TestCase& test_case, const TargetTable& table,
                            std::size_t segment, int step) const;
  // Of a segment's steps those before the target has arrived, and the one at whose end it has.
  int count_distinct_steps(const Segment& segment) const;

  RobotModel robot_;
  TrackingTask task_;
  std::optional<ElbowUpKinematics> closed_form_;
  std::shared_ptr<const NumericKinematics> numeric_;  // where there is no closed form
  std::vector<Eigen::Vector3d> tool_points_m_;        // from the tip, along its frame
  std::shared_ptr<const articulated::ChainModel> chain_;
};

enum class SimulationStatus : std::uint8_t { ok, cut_off, diverged, unreachable, abandoned };
const char* to_string(SimulationStatus status);

struct RecordingOptions {
  bool error_series = false;  // |tip - target| at the end of every control period
  bool trajectory = false;
  bool motion = false;  // only what measures of the motion need (sim/response.hpp): much less

  bool any() const { return error_series || trajectory || motion; }
};

struct TrajectorySample {
  double time_s;
  std::vector<double> q_rad, target_rad, effort_n_m;
  Eigen::Vector3d tip_m, target_m;
};

struct TrackingResult {
  SimulationStatus status = SimulationStatus::ok;
  std::string reason;  // for every status but ok
  int steps = 0;       // control periods simulated
  std::vector<double>
      point_error_m;  // points 1..n, as far as they were reached; after a cut-off or divergence in
                      // training the rest is filled with the cut-off error
  double mean_error_m = 0;  // the case's error; meaningful for ok and, under a cut-off policy, for
                            // cut_off and diverged; for abandoned a lower bound of it
  std::vector<double> peak_effort_n_m, rms_effort_n_m, saturated_share;  // one a joint
  // Positive mechanical work of all joints: the sum of max(0, effort x displacement).
  double energy_j = 0;
  std::vector<double> error_series_m;        // on request
  std::vector<TrajectorySample> trajectory;  // on request
  // With `motion`, at the end of every control period: the tip, and the joints' angles (rad or m,
  // in whole turns as the engine counts them), steps x joints, row-major.
  std::vector<Eigen::Vector3d> tips_m;
  std::vector<double> angles_rad;
};

// One simulation: a design on a test case.
struct TrackingJob {
  const ArmDesign* design = nullptr;
  const TargetTable* targets = nullptr;
  // Training only: a case whose error exceeds this is abandoned; that point and the rest count as
  // this error.
  double cutoff_m = std::numeric_limits<double>::infinity();
  RecordingOptions recording;
  // The simulation is abandoned at the end of the first point after which the case's error is
  // certain to exceed this: the errors of the points that counted so far, divided by the number of
  // all that count, do already. After the last point there is nothing left to abandon.
  double abandon_above_m = std::numeric_limits<double>::infinity();
  // Where the design or the case changes the arm itself: its own setup, of the same task (speed and
  // load aside) and number of joints.
  const TrackingSetup* setup = nullptr;
  // What else the case's plant has. Null: nothing.
  const PlantVariation* variation = nullptr;

  // The setup to simulate it with: its own, or that of the batch.
  const TrackingSetup& choose_setup(const TrackingSetup& of_batch) const {
    return setup != nullptr ? *setup : of_batch;
  }
};

// Error{usage} where the controller of a job that can be simulated wants efforts that its table of
// targets does not hold.
void check_feed_forward(const TrackingJob& job);

}  // namespace armwright
