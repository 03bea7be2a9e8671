#include "sim/dynamics/arm_equations.hpp"

#include <algorithm>
#include <vector>

#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/dynamics/joint_effort.hpp"

namespace armwright::articulated {
namespace {

struct EquationLevel;  // tags the code that this file instantiates
using EquationNumber = lanes::Single<double, EquationLevel>;
using EquationChain = ChainShape<0, kAnyShape, true>;

}  // namespace

struct ArmEquations::Numbers {
  explicit Numbers(const ChainModel& chain)
      : model(chain.numbers().begin(), chain.numbers().end()),
        scratch(static_cast<std::size_t>(calc_dynamics_packs(chain.joints())), EquationNumber(0)),
        memory(scratch.data()),
        dynamics(EquationChain(chain.joints(), chain.flags().data(), chain.tilted_gravity()),
                 model.data(), memory) {}

  std::vector<EquationNumber> model, scratch, q, rate;
  EquationNumber* memory;
  ChainDynamics<EquationNumber, EquationChain> dynamics;
};

ArmEquations::ArmEquations(const ChainModel& chain) : numbers_(std::make_unique<Numbers>(chain)) {}

ArmEquations::~ArmEquations() = default;

void ArmEquations::set(std::span<const double> q, std::span<const double> rate) {
  Numbers& its = *numbers_;
  its.q.assign(q.begin(), q.end());
  its.rate.assign(rate.begin(), rate.end());
  its.dynamics.set_posture(its.q.data(), true);
  its.dynamics.calc_equations(its.q.data(), its.rate.data());
}

double ArmEquations::bias(std::size_t joint) const {
  return numbers_->dynamics.bias(static_cast<int>(joint)).v;
}

double ArmEquations::mass(std::size_t row, std::size_t column) const {
  return numbers_->dynamics
      .mass(static_cast<int>(std::max(row, column)), static_cast<int>(std::min(row, column)))
      .v;
}

double ArmEquations::calc_effort(std::size_t joint, std::span<const double> acceleration) const {
  double effort = bias(joint);
  for (std::size_t k = 0; k < acceleration.size(); ++k) {
    effort += mass(joint, k) * acceleration[k];
  }
  return effort;
}

std::vector<double> ArmEquations::calc_holding_efforts(const RobotModel& robot,
                                                       std::span<const double> q) {
  set(q, std::vector<double>(q.size(), 0));
  std::vector<double> efforts;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Joint& joint = robot.joints[i];
    efforts.push_back(bias(i) + (joint.plant.offset - calc_counterbalance(joint, q[i])));
  }
  return efforts;
}

}  // namespace armwright::articulated
