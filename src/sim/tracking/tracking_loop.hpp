// One tracking simulation, written once for every engine that steps a single arm: the timeline, the
// controllers and the measures. An `Arm` needs the member functions step(effort, dt, inertia),
// read_positions(q), read_rates(qd), tip_position_m() and tool_point_m(point). It throws
// DivergenceError if it cannot be stepped any further.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "sim/tracking/engine_support.hpp"
#include "sim/tracking/simulation.hpp"

namespace armwright {

// The plant of one arm for an engine that steps single arms: what stands between motors and links
// (joint_plant.hpp), and perturbations (plant_variation.hpp).
class ArmPlant {
 public:
  // Starts at rest with joint positions q (rad or m). The robot and the variation must outlive the
  // object. `variation` may be null.
  ArmPlant(const RobotModel& robot, const PlantVariation* variation, std::span<const double> q,
           double substep_s);
  ~ArmPlant();

  // Lets drives turn what the controllers command into efforts, if the task has drives with inner
  // loops. Call it before the first step.
  void add_drives(const TrackingSetup& setup, const TrackingJob& job);

  // Returns the joint positions as the controllers measure them now.
  std::span<const double> measure();
  // Computes what acts on the links during a substep, given what the controllers command and the
  // joints' state at its start. Moves the motors of elastic joints to its end.
  void act(std::span<const double> command, std::span<const double> q, std::span<const double> qd);
  // Return the efforts (N m or N) on the links, and the inertia (kg m^2 or kg) that joins each
  // joint. It is empty if the robot's joints are ideal.
  std::span<const double> effort() const { return acting_effort_; }
  std::span<const double> inertia() const { return inertia_; }
  // Stores the joint positions that a substep ended with.
  void remember(std::span<const double> q);
  // Ends the drives' substep, given the joints' rates at its end.
  void end_substep(std::span<const double> qd);
  // Returns the position that the controller's effort pushes: that of the link, which is q, or of
  // the motor of an elastic joint.
  double get_pushed(std::size_t joint, double q) const;

  // The measures of a drive in one control period: its last effort, the largest magnitude, the mean square
  // (N m or N), the share of clamped substeps, and the positive work (J).
  struct DriveMeasures {
    double effort, peak, square, clamped, work;
  };
  // Returns the measures of the period that ends, and begins those of the next one. Returns nothing
  // if there are no drives with inner loops.
  std::optional<DriveMeasures> take_measures(std::size_t joint);

 private:
  struct Drives;
  double drive(std::size_t joint, double command, double q, double rate);
  double get_measured(std::size_t joint, double q) const;
  double perturb(std::size_t joint, double effort, double q, double rate) const;
  double pass_spring(std::size_t joint, double effort, double q, double rate);

  const RobotModel& robot_;
  const PlantVariation* variation_;
  double substep_s_;
  std::vector<std::vector<double>> past_;  // a ring of measured positions: one more than the delay
  std::size_t newest_ = 0;
  std::vector<double> measured_, acting_effort_, inertia_;
  std::vector<double> motor_, motor_rate_;  // used for elastic joints
  std::unique_ptr<Drives> drives_;          // null: the controllers command efforts
};

// One simulation of one job.
class TrackingLoop {
 public:
  // Both arguments must outlive the object. Throws Error{usage} if the design's numbers make no
  // controller, or if the job lacks feed-forward efforts.
  TrackingLoop(const TrackingSetup& setup, const TrackingJob& job);

  // Simulates the job on an arm at its start. Call it once.
  template <class Arm>
  TrackingResult run(Arm& arm);

 private:
  template <class Arm>
  void step(Arm& arm, int step);  // steps count from the beginning of the case
  // Steps a plant that is not ideal by one substep.
  template <class Arm>
  void step_plant(Arm& arm);
  // Adds the measures of a joint's drive and sets the joint's effort. Returns whether it has one.
  bool add_drive_measures(std::size_t joint);
  // Returns the squared error (m^2) at the end of a segment's move: that of the tip, or the mean
  // over the tool points.
  template <class Arm>
  double calc_squared_error(const Arm& arm, const Segment& segment) const;
  template <class Arm>
  void record(const Arm& arm, const Segment& segment, int step);

  const TrackingSetup& setup_;
  const TrackingJob& job_;
  double period_s_;
  double substep_s_;
  std::vector<std::unique_ptr<Controller>> controllers_;
  bool has_feed_forward_ = false;
  std::vector<double> q_;
  std::vector<double> effort_;         // during a control period: what the controllers command
  std::vector<double> pushed_before_;  // at the start of the period (ArmPlant::get_pushed())
  std::optional<ArmPlant> plant_;      // empty: the ideal plant
  std::vector<double> plant_q_, plant_rate_;
  TrackingResult result_;
};

template <class Arm>
void TrackingLoop::step(Arm& arm, int step) {
  const auto targets = job_.targets->positions(step);
  const std::span<const double> measured = plant_ ? plant_->measure() : q_;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    const double feed_forward = has_feed_forward_ ? job_.targets->feed_forward(step)[i] : 0;
    effort_[i] = controllers_[i]->step(targets[i], measured[i], period_s_, feed_forward);
  }
  for (int substep = 0; substep < setup_.task().physics.substeps; ++substep) {
    if (plant_) {
      step_plant(arm);
    } else {
      arm.step(effort_, substep_s_);
    }
  }
  arm.read_positions(q_);
  ++result_.steps;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    if (plant_ && add_drive_measures(i)) {
      continue;
    }
    const double magnitude = std::abs(effort_[i]);
    result_.peak_effort[i] = std::max(result_.peak_effort[i], magnitude);
    result_.rms_effort[i] += magnitude * magnitude;
    result_.saturated_share[i] += controllers_[i]->saturated() ? 1 : 0;
    const double pushed = plant_ ? plant_->get_pushed(i, q_[i]) : q_[i];
    const JointKind kind = setup_.robot().joints[i].kind;
    result_.energy_j +=
        std::max(0.0, effort_[i] * calc_displacement(kind, pushed_before_[i], pushed));
    pushed_before_[i] = pushed;
  }
}

template <class Arm>
void TrackingLoop::step_plant(Arm& arm) {
  arm.read_rates(plant_rate_);
  plant_->act(effort_, plant_q_, plant_rate_);
  arm.step(plant_->effort(), substep_s_, plant_->inertia());
  arm.read_positions(plant_q_);
  plant_->remember(plant_q_);
  if (setup_.task().drives.has_loops()) {
    arm.read_rates(plant_rate_);
    plant_->end_substep(plant_rate_);
  }
}

template <class Arm>
double TrackingLoop::calc_squared_error(const Arm& arm, const Segment& segment) const {
  const auto targets_m =
      job_.targets->tool_points(static_cast<std::size_t>(&segment - job_.targets->segments.data()));
  if (targets_m.empty()) {
    return (arm.tip_position_m() - segment.to_m).squaredNorm();
  }
  double sum = 0;
  for (std::size_t i = 0; i < targets_m.size(); ++i) {
    sum += (arm.tool_point_m(i) - targets_m[i]).squaredNorm();
  }
  return sum / static_cast<double>(targets_m.size());
}

template <class Arm>
void TrackingLoop::record(const Arm& arm, const Segment& segment, int step) {
  const Eigen::Vector3d tip = arm.tip_position_m();
  if (job_.recording.motion) {
    result_.tips_m.push_back(tip);
    result_.joint_positions.insert(result_.joint_positions.end(), q_.begin(), q_.end());
  }
  if (!job_.recording.error_series && !job_.recording.trajectory) {
    return;  // the target's position costs more to compute than all the rest
  }
  const Eigen::Vector3d target = setup_.calc_target_position(segment, step);
  if (job_.recording.error_series) {
    result_.error_series_m.push_back((tip - target).norm());
  }
  if (job_.recording.trajectory) {
    const auto targets = job_.targets->positions(segment.first_step + step);
    result_.trajectory.push_back({result_.steps * period_s_, q_,
                                  std::vector<double>(targets.begin(), targets.end()), effort_, tip,
                                  target});
  }
}

template <class Arm>
TrackingResult TrackingLoop::run(Arm& arm) {
  const bool recording = job_.recording.any();
  try {
    arm.read_positions(q_);
    pushed_before_ = q_;
    if (job_.has_plant(setup_)) {
      plant_.emplace(setup_.robot(), job_.variation, q_, substep_s_);
      plant_->add_drives(setup_, job_);
      plant_q_ = q_;
      plant_rate_.resize(q_.size());
    }
    for (const Segment& segment : job_.targets->segments) {
      double worst_squared = 0;
      for (int k = 0; k < segment.steps; ++k) {
        step(arm, segment.first_step + k);
        if (k >= segment.window_start) {
          worst_squared = std::max(worst_squared, calc_squared_error(arm, segment));
        }
        if (recording) {
          record(arm, segment, k);
        }
        if (worst_squared > job_.cutoff_m * job_.cutoff_m) {
          apply_cutoff(setup_.task(), job_, result_);
          complete_result(setup_.task(), job_, result_);
          return std::move(result_);
        }
      }
      result_.point_error_m.push_back(std::sqrt(worst_squared));
      if (apply_abandonment(setup_.task(), job_, result_)) {
        break;
      }
    }
  } catch (const DivergenceError& error) {
    apply_divergence(setup_.task(), job_, error.what(), result_);
  }
  complete_result(setup_.task(), job_, result_);
  return std::move(result_);
}

}  // namespace armwright
