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

// Inverse dynamics of an arm, with all that its joints' plants take from the motors.
class EffortModel {
 public:
  EffortModel(const RobotModel& robot, const articulated::ChainModel& chain)
      : robot_(robot),
        chain_(chain),
        has_plant_(robot.has_plant()),
        model_(chain.numbers().begin(), chain.numbers().end()),
        scratch_(static_cast<std::size_t>(articulated::calc_dynamics_packs(chain.joints())),
                 FeedForwardNumber(0)),
        q_(robot.joint_count()) {}

  JointKind kind(std::size_t joint) const {
    return (chain_.flags()[joint] & articulated::kPrismatic) == 0 ? JointKind::revolute
                                                                  : JointKind::prismatic;
  }

  // Writes the efforts of a period, one per joint: positions and rates at its start, the
  // accelerations during it, and the rates at its end.
  void calc(const double* positions, const std::vector<FeedForwardNumber>& rate,
            const std::vector<FeedForwardNumber>& acceleration,
            const std::vector<FeedForwardNumber>& next_rate, double* efforts) {
    const std::size_t n = q_.size();
    FeedForwardNumber* memory = scratch_.data();
    articulated::ChainDynamics<FeedForwardNumber, FeedForwardChain> dynamics(
        FeedForwardChain(chain_.joints(), chain_.flags().data(), chain_.tilted_gravity()),
        model_.data(), memory);
    for (std::size_t i = 0; i < n; ++i) {
      q_[i] = positions[i];
    }
    dynamics.set_posture(q_.data(), true);
    dynamics.calc_equations(q_.data(), rate.data());
    for (std::size_t i = 0; i < n; ++i) {
      double effort = dynamics.bias(static_cast<int>(i)).v;
      for (std::size_t j = 0; j < n; ++j) {
        effort +=
            dynamics.mass(static_cast<int>(std::max(i, j)), static_cast<int>(std::min(i, j))).v *
            acceleration[j].v;
      }
      efforts[i] = effort;
      if (has_plant_) {
        efforts[i] +=
            calc_plant_effort(robot_.joints[i], positions[i], next_rate[i].v, acceleration[i].v);
      }
    }
  }

 private:
  const RobotModel& robot_;
  const articulated::ChainModel& chain_;
  bool has_plant_;
  std::vector<FeedForwardNumber> model_, scratch_, q_;
};

}  // namespace

void TrackingSetup::fill_efforts(TargetTable& table) const {
  const FeedForward kind = task_.feed_forward;
  const bool holds = task_.control_start == ControlStart::gravity;
  if (kind == FeedForward::none && !holds) {
    return;
  }
  const double period_s = task_.control_period_s;
  const std::size_t n = table.joints;
  EffortModel model(robot_, *chain_);
  std::vector<FeedForwardNumber> rate(n, FeedForwardNumber(0));  // at the start of the period
  std::vector<FeedForwardNumber> acceleration = rate;
  const double* before = table.start_positions.data();
  if (holds) {
    table.holding_effort.resize(n);
    model.calc(before, rate, acceleration, rate, table.holding_effort.data());
  }
  if (kind == FeedForward::none) {
    return;
  }
  table.feed_forward_effort.resize(table.joint_positions.size());
  for (int step = 0; step < table.steps; ++step) {
    const double* const target = table.positions(step).data();
    std::vector<FeedForwardNumber> next = rate;
    if (kind == FeedForward::inverse_dynamics) {
      for (std::size_t i = 0; i < n; ++i) {
        next[i] = calc_displacement(model.kind(i), before[i], target[i]) / period_s;
        acceleration[i] = (next[i].v - rate[i].v) / period_s;
      }
    }
    model.calc(before, rate, acceleration, next,
               table.feed_forward_effort.data() + static_cast<std::size_t>(step) * n);
    rate = next;
    before = target;
  }
}

}  // namespace armwright
