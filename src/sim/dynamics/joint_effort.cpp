#include "sim/dynamics/joint_effort.hpp"

#include <cmath>

namespace armwright::articulated {
namespace {

struct EffortLevel;  // tags the code that this file instantiates
using Number = lanes::Single<double, EffortLevel>;

}  // namespace

double calc_friction_chord(const JointPlant& plant, double rate) {
  const FrictionNumbers<Number> numbers{plant.coulomb + plant.stribeck, plant.stribeck,
                                        1 / plant.transition_rate, 1 / plant.stribeck_rate};
  const Fraction<Number> dry = calc_friction_chord(numbers, Number(rate), plant.stribeck != 0);
  return plant.get_drag() + dry.n.v / dry.d.v;
}

double calc_counterbalance(const Joint& joint, double position) {
  const BalanceGrid grid = make_balance_grid(joint);
  return grid.efforts == nullptr
             ? 0
             : calc_balance(grid, Number(position), joint.kind == JointKind::prismatic).v;
}

double calc_plant_effort(const Joint& joint, double position, double rate, double acceleration) {
  const JointPlant& its = joint.plant;
  return its.armature * acceleration + its.offset + calc_friction_chord(its, rate) * rate -
         calc_counterbalance(joint, position);
}

BalanceGrid make_balance_grid(const Joint& joint) {
  const Counterbalance& its = joint.plant.counterbalance;
  if (its.efforts.empty()) {
    return {0, 0, 0, 0, nullptr};
  }
  const int last = static_cast<int>(its.efforts.size()) - 1;
  // The joint's range may lie anywhere in that of the efforts.
  const bool has_range = std::isfinite(joint.lower) && joint.upper > joint.lower;
  const double middle = has_range ? (joint.lower + joint.upper) / 2 : (its.lower + its.upper) / 2;
  return {middle, its.lower, last / (its.upper - its.lower), last, its.efforts.data()};
}

}  // namespace armwright::articulated
