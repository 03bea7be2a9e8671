#include "sim/tracking/tracking_loop.hpp"

#include <algorithm>
#include <cmath>

#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {

ArmPlant::ArmPlant(const RobotModel& robot, const PlantVariation* variation,
                   std::span<const double> q, double substep_s)
    : robot_(robot),
      variation_(variation),
      substep_s_(substep_s),
      past_(static_cast<std::size_t>(variation == nullptr ? 0 : variation->delay_substeps) + 1,
            std::vector<double>(q.begin(), q.end())),
      measured_(q.size()),
      acting_effort_(q.size()),
      inertia_(robot.has_plant() ? q.size() : 0),
      motor_(q.begin(), q.end()),
      motor_rate_(q.size()) {}

std::span<const double> ArmPlant::measure() {
  // The oldest positions come after the newest ones in the ring.
  measured_ = past_[(newest_ + 1) % past_.size()];
  const double quantum = variation_ == nullptr ? 0 : variation_->quantum;
  for (std::size_t i = 0; quantum > 0 && i < measured_.size(); ++i) {
    // The motor of an elastic joint may have turned further.
    const double position =
        robot_.joints[i].kind == JointKind::revolute ? wrap_angle(measured_[i]) : measured_[i];
    measured_[i] = std::nearbyint(position / quantum) * quantum;
  }
  return measured_;
}

void ArmPlant::act(std::span<const double> effort, std::span<const double> q,
                   std::span<const double> qd) {
  for (std::size_t i = 0; i < acting_effort_.size(); ++i) {
    const Joint& joint = robot_.joints[i];
    const JointPlant& its = joint.plant;
    double acting = effort[i];
    if (variation_ != nullptr) {
      acting = perturb(i, acting, q[i], its.is_elastic() ? motor_rate_[i] : qd[i]);
    }
    if (its.is_elastic()) {
      acting = pass_spring(i, acting, q[i], qd[i]);
    } else if (its.has_friction()) {
      const double chord = articulated::calc_friction_chord(its, qd[i]);
      acting -= its.offset + chord * qd[i];
      inertia_[i] = its.armature + substep_s_ * chord;
    } else if (!inertia_.empty()) {
      inertia_[i] = its.armature;
    }
    acting_effort_[i] = acting + articulated::calc_counterbalance(joint, q[i]);
  }
}

double ArmPlant::perturb(std::size_t joint, double effort, double q, double rate) const {
  const PlantVariation& its = *variation_;
  const bool turns = robot_.joints[joint].kind == JointKind::revolute;
  const double ripple = turns ? its.torque_ripple[joint] * std::sin(its.ripple_cycles_per_turn * q +
                                                                    its.ripple_phase_rad[joint])
                              : 0;
  const double sliding = std::clamp(rate / its.friction_transition_rate, -1.0, 1.0);
  return effort + effort * ripple -
         (its.viscous_friction[joint] * rate + its.coulomb_friction[joint] * sliding);
}

// Moves the motor by a substep and returns the spring's effort at its start.
double ArmPlant::pass_spring(std::size_t joint, double effort, double q, double rate) {
  const JointPlant& its = robot_.joints[joint].plant;
  double& place = motor_[joint];
  double& speed = motor_rate_[joint];
  const double stretch = calc_displacement(robot_.joints[joint].kind, q, place);
  const double spring = its.stiffness * stretch + its.damping * (speed - rate);
  const double chord = articulated::calc_friction_chord(its, speed);
  speed += substep_s_ *
           ((effort - spring - its.offset - chord * speed) / (its.armature + substep_s_ * chord));
  place += substep_s_ * speed;
  return spring;
}

void ArmPlant::remember(std::span<const double> q) {
  newest_ = (newest_ + 1) % past_.size();
  for (std::size_t i = 0; i < q.size(); ++i) {
    const JointPlant& its = robot_.joints[i].plant;
    const bool at_motor = its.is_elastic() && its.measured == MeasuredSide::motor;
    past_[newest_][i] = at_motor ? motor_[i] : q[i];
  }
}

double ArmPlant::get_pushed(std::size_t joint, double q) const {
  return robot_.joints[joint].plant.is_elastic() ? motor_[joint] : q;
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
    if (!job.targets->holding_effort.empty()) {
      controllers_.back()->hold(job.targets->holding_effort[i]);
    }
  }
  q_.resize(joints);
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
