#include "sim/tracking/arm_plant.hpp"

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
      torque_(q.size()) {}

std::span<const double> ArmPlant::measure() {
  // The one after the newest is the oldest.
  measured_ = past_[(newest_ + 1) % past_.size()];
  const double quantum = variation_.quantisation_rad;
  for (double& angle : measured_) {
    angle = quantum > 0 ? std::nearbyint(angle / quantum) * quantum : angle;
  }
  return measured_;
}

std::span<const double> ArmPlant::calc_torque(std::span<const double> effort_n_m,
                                              std::span<const double> q,
                                              std::span<const double> qd) {
  for (std::size_t i = 0; i < torque_.size(); ++i) {
    const bool turns = robot_.joints[i].kind == JointKind::revolute;
    const double ripple =
        turns ? variation_.torque_ripple[i] * std::sin(variation_.ripple_cycles_per_turn * q[i] +
                                                       variation_.ripple_phase_rad[i])
              : 0;
    const double sliding = std::clamp(qd[i] / variation_.friction_transition_rad_per_s, -1.0, 1.0);
    torque_[i] = effort_n_m[i] + effort_n_m[i] * ripple -
                 (variation_.viscous_friction_n_m_s_per_rad[i] * qd[i] +
                  variation_.coulomb_friction_n_m[i] * sliding);
  }
  return torque_;
}

void ArmPlant::remember(std::span<const double> q) {
  newest_ = (newest_ + 1) % past_.size();
  std::copy(q.begin(), q.end(), past_[newest_].begin());
}

}  // namespace armwright
