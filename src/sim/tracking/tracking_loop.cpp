#include "sim/tracking/tracking_loop.hpp"

#include <algorithm>
#include <cmath>

namespace armwright {

ArmPlant::ArmPlant(const PlantVariation& variation, const RobotModel& robot,
                   std::span<const double> q)
    : variation_(variation),
      robot_(robot),
      past_(static_cast<std::size_t>(variation.delay_substeps) + 1,
            std::vector<double>(q.begin(), q.end())),
      measured_(q.size()),
      acting_effort_(q.size()) {}

std::span<const double> ArmPlant::measure() {
  // The oldest positions come after the newest ones in the ring.
  measured_ = past_[(newest_ + 1) % past_.size()];
  const double quantum = variation_.quantum;
  for (double& position : measured_) {
    position = quantum > 0 ? std::nearbyint(position / quantum) * quantum : position;
  }
  return measured_;
}

std::span<const double> ArmPlant::calc_effort(std::span<const double> effort,
                                              std::span<const double> q,
                                              std::span<const double> qd) {
  for (std::size_t i = 0; i < acting_effort_.size(); ++i) {
    const bool turns = robot_.joints[i].kind == JointKind::revolute;
    const double ripple =
        turns ? variation_.torque_ripple[i] * std::sin(variation_.ripple_cycles_per_turn * q[i] +
                                                       variation_.ripple_phase_rad[i])
              : 0;
    const double sliding = std::clamp(qd[i] / variation_.friction_transition_rate, -1.0, 1.0);
    acting_effort_[i] =
        effort[i] + effort[i] * ripple -
        (variation_.viscous_friction[i] * qd[i] + variation_.coulomb_friction[i] * sliding);
  }
  return acting_effort_;
}

void ArmPlant::remember(std::span<const double> q) {
  newest_ = (newest_ + 1) % past_.size();
  std::copy(q.begin(), q.end(), past_[newest_].begin());
}

TrackingLoop::TrackingLoop(const TrackingSetup& setup, const TrackingJob& job)
    : setup_(setup),
      job_(job),
      period_s_(setup.task().control_period_s),
      substep_s_(period_s_ / setup.task().physics.substeps) {
  const std::size_t joints = setup.robot().joint_count();
  const ControllerRow& row = find_controller(job.design->controller);
  check_feed_forward(job);
  has_feed_forward_ = row.feed_forward != FeedForward::none;
  for (std::size_t i = 0; i < joints; ++i) {
    const JointDrive& drive = job.design->joints[i];
    controllers_.push_back(row.make(drive.gains, drive.limits, setup.robot().joints[i].kind));
  }
  q_.resize(joints);
  q_before_.resize(joints);
  effort_.resize(joints);
  result_.peak_effort.resize(joints);
  result_.rms_effort.resize(joints);
  result_.saturated_share.resize(joints);
  result_.point_error_m.reserve(job.targets->segments.size());
  if (job.recording.error_series) {
    result_.error_series_m.reserve(static_cast<std::size_t>(job.targets->steps));
  }
}

}  // namespace armwright
