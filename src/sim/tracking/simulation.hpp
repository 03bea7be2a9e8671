// One simulation: the job that an engine gets, and the result that it returns. A job is a design on
// a test case.
//
// Point k's error is the largest |tip - target| at the ends of the control periods from t_m to the
// end of segment k. A case's error is the mean over its points. The first point does not count
// unless the task has `count_first_point`.
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

struct RecordingOptions {
  bool error_series = false;  // |tip - target| at the end of every control period
  bool trajectory = false;
  bool motion = false;  // only what response.hpp needs: much less than a trajectory

  bool any() const { return error_series || trajectory || motion; }
};

// Joint positions are in rad or m, efforts in N m or N.
struct TrackingJob {
  const ArmDesign* design = nullptr;
  const TargetTable* targets = nullptr;
  // For training only. A case is cut off at the first point whose error exceeds this: that point
  // and all later ones get this error.
  double cutoff_m = std::numeric_limits<double>::infinity();
  RecordingOptions recording;
  // The simulation is abandoned after the first point at which the case's error is certain to
  // exceed this value: the sum of the errors so far, divided by the number of all points that
  // count, exceeds it already. After the last point it is not abandoned.
  double abandon_above_m = std::numeric_limits<double>::infinity();
  // Not null if the design or the case changes the arm itself. The setup must have the same task
  // (except speed and load) and the same number of joints as the batch's.
  const TrackingSetup* setup = nullptr;
  const PlantVariation* variation = nullptr;  // null: the nominal plant

  // Returns the setup to simulate the job with: its own one, or else that of the batch.
  const TrackingSetup& choose_setup(const TrackingSetup& of_batch) const {
    return setup != nullptr ? *setup : of_batch;
  }
};

enum class SimulationStatus : std::uint8_t { ok, cut_off, diverged, unreachable, abandoned };
const char* to_string(SimulationStatus status);

struct TrajectorySample {
  double time_s;
  std::vector<double> q, target_q, effort;  // one number per joint; q (rad or m), effort (N m or N)
  Eigen::Vector3d tip_m, target_m;
};

struct TrackingResult {
  SimulationStatus status = SimulationStatus::ok;
  std::string reason;  // empty only if the status is ok
  int steps = 0;       // control periods simulated
  // One number per point that was reached. After a cut-off or a divergence in training, all points
  // that were not reached have the cut-off error.
  std::vector<double> point_error_m;
  // The case's error. Meaningful if the status is ok, and under a cut-off also if it is cut_off or
  // diverged. If the status is abandoned, it is a lower bound of the error.
  double mean_error_m = 0;
  // One number per joint: efforts in N m or N, and the share of control periods with a clamped one.
  std::vector<double> peak_effort, rms_effort, saturated_share;
  // Positive mechanical work of all joints: the sum of max(0, effort x displacement).
  double energy_j = 0;
  std::vector<double> error_series_m;        // filled on request
  std::vector<TrajectorySample> trajectory;  // filled on request
  // With RecordingOptions::motion: the tip at the end of every control period.
  std::vector<Eigen::Vector3d> tips_m;
  // Likewise the joint positions (rad or m): steps x joints, row-major. Whether whole turns count
  // depends on the engine.
  std::vector<double> joint_positions;
};

}  // namespace armwright
