// One tracking simulation, written once for every engine that steps a single arm: the timeline, the
// controllers and the measures. `Arm` needs step(effort, dt), read_angles(q), read_rates(qd),
// tip_position_m() and tool_point_m(point), and throws DivergenceError when it cannot go on.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/tracking/arm_plant.hpp"
#include "sim/tracking/tracking.hpp"
#include "sim/tracking/tracking_result.hpp"

namespace armwright {

class TrackingLoop {
 public:
  TrackingLoop(const TrackingSetup& setup, const TrackingJob& job);

  template <class Arm>
  TrackingResult run(Arm& arm);

 private:
  template <class Arm>
  void step(Arm& arm, int step);  // counted from the beginning of the case
  // A substep of a perturbed plant.
  template <class Arm>
  void step_perturbed(Arm& arm);
  // At the end of a segment's move: of the tip, or the mean over the tool points.
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
  std::vector<double> q_, q_before_, effort_;
  std::optional<ArmPlant> plant_;  // if it is perturbed
  std::vector<double> plant_q_, plant_rate_;
  TrackingResult result_;
};

template <class Arm>
void TrackingLoop::step(Arm& arm, int step) {
  const auto targets = job_.targets->angles(step);
  const std::span<const double> measured = plant_ ? plant_->measure() : q_;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    const double feed_forward = has_feed_forward_ ? job_.targets->feed_forward(step)[i] : 0;
    effort_[i] = controllers_[i]->step(targets[i], measured[i], period_s_, feed_forward);
  }
  for (int substep = 0; substep < setup_.task().physics.substeps; ++substep) {
    if (plant_) {
      step_perturbed(arm);
    } else {
      arm.step(effort_, substep_s_);
    }
  }
  q_.swap(q_before_);
  arm.read_angles(q_);
  ++result_.steps;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    const double magnitude = std::abs(effort_[i]);
    result_.peak_effort_n_m[i] = std::max(result_.peak_effort_n_m[i], magnitude);
    result_.rms_effort_n_m[i] += magnitude * magnitude;
    result_.saturated_share[i] += controllers_[i]->saturated() ? 1 : 0;
    result_.energy_j += std::max(
        0.0, effort_[i] * calc_displacement(setup_.robot().joints[i].kind, q_before_[i], q_[i]));
  }
}

template <class Arm>
void TrackingLoop::step_perturbed(Arm& arm) {
  arm.read_rates(plant_rate_);
  arm.step(plant_->calc_torque(effort_, plant_q_, plant_rate_), substep_s_);
  arm.read_angles(plant_q_);
  plant_->remember(plant_q_);
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
    result_.angles_rad.insert(result_.angles_rad.end(), q_.begin(), q_.end());
  }
  if (!job_.recording.error_series && !job_.recording.trajectory) {
    return;  // the target's position would cost more than the rest
  }
  const Eigen::Vector3d target = setup_.calc_target_position(segment, step);
  if (job_.recording.error_series) {
    result_.error_series_m.push_back((tip - target).norm());
  }
  if (job_.recording.trajectory) {
    const auto targets = job_.targets->angles(segment.first_step + step);
    result_.trajectory.push_back({result_.steps * period_s_, q_,
                                  std::vector<double>(targets.begin(), targets.end()), effort_, tip,
                                  target});
  }
}

template <class Arm>
TrackingResult TrackingLoop::run(Arm& arm) {
  const bool recording = job_.recording.any();
  try {
    arm.read_angles(q_);
    if (job_.variation != nullptr) {
      plant_.emplace(*job_.variation, setup_.robot(), q_);
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
