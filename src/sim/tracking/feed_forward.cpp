// Feed-forward efforts: the efforts that an arm's model predicts for the targets of a test case, by
// discrete inverse dynamics. With theta_k the target at the end of control period k, theta_(-1) the
// start, h the control period, and differences of revolute joints taken the short way round,
//   v_k = (theta_k - theta_(k-1)) / h,   a_k = (v_k - v_(k-1)) / h,   v_(-1) = 0,
//   inverse_dynamics:  tau_k = (M(theta_(k-1)) + A) a_k + b(theta_(k-1), v_(k-1)) + f(v_k) - s,
//   gravity:           tau_k = b(theta_(k-1), 0) + f(0) - s,
// with the rotor inertias A, the friction f and the counterbalances s = s(theta_(k-1)) of the joints
// (sim/robot/joint_plant.hpp). Elastic joints count as rigid.
// With the efforts of inverse_dynamics, one step of semi-implicit Euler takes an arm without
// friction and elasticity exactly from the target at the period's start to the target at its end.
// With those of gravity, an arm at rest stays at rest. If a control period has more than one step,
// the arm ends beside the target; the distance grows with h.
// The efforts that hold the arm when its controllers are enabled (ControlStart::gravity) are those of
// gravity in the start positions.
#include <algorithm>
#include <vector>

#include "sim/dynamics/arm_equations.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {
std::vector<double> TrackingSetup::calc_holding_efforts(std::span<const double> q) const {
  return articulated::ArmEquations(*chain_).calc_holding_efforts(robot_, q);
}

void TrackingSetup::fill_efforts(TargetTable& table) const {
  if (task_.control_start == ControlStart::gravity) {
    table.holding_effort = calc_holding_efforts(table.start_positions);
  }
  const FeedForward kind = task_.feed_forward;
  if (kind == FeedForward::none) {
    return;
  }
  const articulated::ChainModel& chain = *chain_;
  const double period_s = task_.control_period_s;
  const bool has_plant = robot_.has_plant();
  const std::size_t n = table.joints;
  const auto joint_kind = [&](std::size_t i) {
    return (chain.flags()[i] & articulated::kPrismatic) == 0 ? JointKind::revolute
                                                             : JointKind::prismatic;
  };
  articulated::ArmEquations equations(chain);
  // The state at the start of the period, and the acceleration during it.
  std::vector<double> rate(n, 0), acceleration(n, 0);
  std::span<const double> before = table.start_positions;
  table.feed_forward_effort.resize(table.joint_positions.size());
  for (int step = 0; step < table.steps; ++step) {
    const std::span<const double> target = table.positions(step);
    std::vector<double> next = rate;
    if (kind == FeedForward::inverse_dynamics) {
      for (std::size_t i = 0; i < n; ++i) {
        next[i] = calc_displacement(joint_kind(i), before[i], target[i]) / period_s;
        acceleration[i] = (next[i] - rate[i]) / period_s;
      }
    }
    equations.set(before, rate);
    double* const efforts = table.feed_forward_effort.data() + static_cast<std::size_t>(step) * n;
    for (std::size_t i = 0; i < n; ++i) {
      efforts[i] = equations.calc_effort(i, acceleration);
      if (has_plant) {
        efforts[i] +=
            articulated::calc_plant_effort(robot_.joints[i], before[i], next[i], acceleration[i]);
      }
    }
    rate = next;
    before = target;
  }
}

}  // namespace armwright
