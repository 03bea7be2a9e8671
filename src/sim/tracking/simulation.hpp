// One simulation: the job that an engine gets, and the result that it returns. A job is a design on
// a test case.
//
// The target moves to point k in segment k (target_table.hpp), arrives t_m seconds after the start
// of the segment, and rests there until the segment ends. The error of point k is the largest
// distance |tip - target| (m) at the ends of the control periods from t_m to the end of the
// segment. If the task has tool points, the distance is the root mean square over the tool points.
// The error of a case is the mean over its points. The first point counts only if the task has
// `count_first_point`.
//
// All types are plain data without locks. Threads may read one object at the same time; only one
// thread may use an object that is being written.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sim/tracking/design.hpp"
#include "sim/tracking/plant_variation.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {

// Selects the optional parts of a TrackingResult.
struct RecordingOptions {
  bool error_series = false;  // fills TrackingResult::error_series_m
  bool trajectory = false;    // fills TrackingResult::trajectory
  bool motion = false;        // fills tips_m and joint_positions: less memory than a trajectory

  bool any() const { return error_series || trajectory || motion; }
};

// One design to simulate on one test case. The job owns none of the objects that it points to. The
// caller keeps them alive and unchanged until PhysicsEngine::simulate() has returned; the result
// refers to none of them. Jobs may share these objects.
struct TrackingJob {
  const ArmDesign* design = nullptr;     // must be set
  const TargetTable* targets = nullptr;  // must be set
  // A finite value is for training only. The simulation is cut off as soon as the error of a point
  // exceeds this value (m). That point and all later points then get this value as their error.
  double cutoff_m = std::numeric_limits<double>::infinity();
  RecordingOptions recording;
  // The simulation is abandoned after the first point at which the case's error is certain to
  // exceed this value (m). This is certain if the sum of the errors so far, divided by the number
  // of all points that count, exceeds the value. After the last point no simulation is abandoned.
  double abandon_above_m = std::numeric_limits<double>::infinity();
  // The setup of this job, if the design or the case changes the arm itself. Null: the job uses the
  // setup that simulate() gets for all jobs. Both setups must have the same number of joints and
  // the same task, except for its speed and load.
  const TrackingSetup* setup = nullptr;
  // Friction, sensor errors and torque ripple. Null: the plant has none of them.
  const PlantVariation* variation = nullptr;

  // Returns the setup of the job, or `of_batch` if the job has none.
  const TrackingSetup& choose_setup(const TrackingSetup& of_batch) const {
    return setup != nullptr ? *setup : of_batch;
  }
  // Returns whether the plant is perturbed, or a joint of the arm is not ideal or has a drive with
  // an inner loop.
  bool has_plant(const TrackingSetup& of_batch) const {
    return variation != nullptr || choose_setup(of_batch).robot().has_plant() ||
           of_batch.task().drives.has_loops();
  }
};

// Says how a simulation ended. TrackingResult::mean_error_m depends on it:
//
//   status       meaning                                       mean_error_m
//   ok           simulated to the end of the case              the error of the case
//   cut_off      the error of a point exceeded `cutoff_m`      the error of the case, where the
//                                                              missing points have `cutoff_m`
//   diverged     the numbers left the range that the engine    as for cut_off if `cutoff_m` is
//                accepts, or were not finite                   finite, else 0 (no error)
//   unreachable  the arm cannot reach a target of the case,    0 (no error)
//                so no step was simulated
//   abandoned    the error will exceed `abandon_above_m`       a lower bound of the error
enum class SimulationStatus : std::uint8_t { ok, cut_off, diverged, unreachable, abandoned };
const char* to_string(SimulationStatus status);

// The state at the end of one control period. Positions are in the world frame.
struct TrajectorySample {
  double time_s;  // since the start of the case
  // One number per joint: joint positions and setpoints (rad or m), and the motors' efforts (N m or
  // N) in the last substep.
  std::vector<double> q, target_q, effort;
  Eigen::Vector3d tip_m, target_m;
};

struct TrackingResult {
  SimulationStatus status = SimulationStatus::ok;
  std::string reason;  // empty only if the status is ok
  int steps = 0;       // control periods simulated
  // The errors of the points whose segments were simulated to their ends. After a cut-off, or a
  // divergence with a finite cut-off, the remaining points follow with the cut-off as their error.
  std::vector<double> point_error_m;
  double mean_error_m = 0;  // see SimulationStatus
  // One number per joint over the simulated control periods: the largest magnitude and the root
  // mean square of the effort (N m or N), and the share (0 to 1) of periods with a clamped effort.
  // Efforts are those of the motors: the controllers' or, where these command drives, the drives',
  // which are taken in every substep. Empty if the status is unreachable.
  std::vector<double> peak_effort, rms_effort, saturated_share;
  // Positive mechanical work of all joints: the sum of max(0, effort x displacement).
  double energy_j = 0;
  // The members below are empty unless RecordingOptions asks for them. They have one row per
  // simulated control period, taken at its end.
  std::vector<double> error_series_m;  // |tip - target|
  std::vector<TrajectorySample> trajectory;
  std::vector<Eigen::Vector3d> tips_m;  // in the world frame
  // Joint positions (rad or m): steps x joints, row-major. Some engines leave out the whole turns
  // of a revolute joint.
  std::vector<double> joint_positions;
};

}  // namespace armwright
