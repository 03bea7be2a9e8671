// How fast an arm's elastic and unactuated joints swing, which decides the steps that can simulate them.
//
// The stretches e of the springs obey, with the motors' efforts held,
//   edd = -(A^-1 + (M^-1)_ee) (K e + Z ed),
// with the diagonal matrices A, K and Z of the elastic joints' rotor inertias, stiffnesses and
// dampings, and (M^-1)_ee the part of the inverse mass matrix that belongs to these joints. For one
// joint the square of its rate is k (1 / A + 1 / M). Unactuated joints have no rotor: A^-1 counts as
// 0. Their damping does not count, as engines take it as friction, which is implicit. Semi-implicit Euler with the step h makes the
// frequency (w h)^2 / 24 too high and diverges at w h = 2.
#pragma once

#include <optional>

#include "sim/robot/robot_model.hpp"

namespace armwright {

struct ElasticMode {
  double rate_rad_per_s;  // the larger of the swing's w and of the damping's rate of decay
  std::size_t joint;      // with the largest part in it
};

// Returns the fastest mode over postures drawn from the joints' ranges, the same ones in every
// call. Returns nothing if no joint has a spring.
std::optional<ElasticMode> find_fastest_mode(const RobotModel& robot);

// The largest rate times step (rad) that is simulated: there the frequency is 1 % off.
inline constexpr double kMostTurnPerStep_rad = 0.5;
// Returns the substeps of a control period that a mode needs at least.
int count_substeps(const ElasticMode& mode, double control_period_s);

}  // namespace armwright
