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
#include <algorithm>
#include <vector>

#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {
namespace {

struct FeedForwardLevel;  // tags the code that this file instantiates
using FeedForwardNumber = lanes::Single<double, FeedForwardLevel>;
using FeedForwardChain = articulated::ChainShape<0, articulated::kAnyShape, true>;

// Returns the effort that a joint's plant takes from the motor.
double calc_plant_effort(const Joint& joint, double q, double rate, double acceleration) {
  const JointPlant& its = joint.plant;
  return its.armature * acceleration + its.offset +
         articulated::calc_friction_chord(its, rate) * rate -
         articulated::calc_counterbalance(joint, q);
}

}  // namespace

void TrackingSetup::fill_feed_forward(TargetTable& table) const {
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
  const std::vector<FeedForwardNumber> model(chain.numbers().begin(), chain.numbers().end());
  std::vector<FeedForwardNumber> scratch(
      static_cast<std::size_t>(articulated::calc_dynamics_packs(chain.joints())),
      FeedForwardNumber(0));
  FeedForwardNumber* memory = scratch.data();
  articulated::ChainDynamics<FeedForwardNumber, FeedForwardChain> dynamics(
      FeedForwardChain(chain.joints(), chain.flags().data(), chain.tilted_gravity()), model.data(),
      memory);
  // The state at the start of the period, and the acceleration during it.
  std::vector<FeedForwardNumber> q(n), rate(n, FeedForwardNumber(0)),
      acceleration(n, FeedForwardNumber(0));
  const double* before = table.start_positions.data();
  table.feed_forward_effort.resize(table.joint_positions.size());
  for (int step = 0; step < table.steps; ++step) {
    const double* const target = table.positions(step).data();
    std::vector<FeedForwardNumber> next = rate;
    if (kind == FeedForward::inverse_dynamics) {
      for (std::size_t i = 0; i < n; ++i) {
        next[i] = calc_displacement(joint_kind(i), before[i], target[i]) / period_s;
        acceleration[i] = (next[i].v - rate[i].v) / period_s;
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = before[i];
    }
    dynamics.set_posture(q.data(), true);
    dynamics.calc_equations(q.data(), rate.data());
    double* const efforts = table.feed_forward_effort.data() + static_cast<std::size_t>(step) * n;
    for (std::size_t i = 0; i < n; ++i) {
      double effort = dynamics.bias(static_cast<int>(i)).v;
      for (std::size_t j = 0; j < n; ++j) {
        effort +=
            dynamics.mass(static_cast<int>(std::max(i, j)), static_cast<int>(std::min(i, j))).v *
            acceleration[j].v;
      }
      efforts[i] = effort;
      if (has_plant) {
        efforts[i] += calc_plant_effort(robot_.joints[i], before[i], next[i].v, acceleration[i].v);
      }
    }
    rate = next;
    before = target;
  }
}

}  // namespace armwright
