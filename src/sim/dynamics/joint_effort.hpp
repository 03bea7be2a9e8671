// The laws of joint_laws.hpp for the joints of a robot, as single numbers.
#pragma once

#include "sim/dynamics/joint_laws.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::articulated {

// Returns the slope phi(v) of the friction's chord.
double calc_friction_chord(const JointPlant& plant, double rate);

// Returns the counterbalance's effort s(q), 0 if there is none. The position of a revolute joint
// may have whole turns too many.
double calc_counterbalance(const Joint& joint, double position);

// Returns the effort that the joint's plant takes from the motor, beside the links: A a + f(v) - s(q)
// (sim/robot/joint_plant.hpp).
double calc_plant_effort(const Joint& joint, double position, double rate, double acceleration);

// Returns the grid of a joint's counterbalance, which must outlive it. Without efforts all is 0.
BalanceGrid make_balance_grid(const Joint& joint);

}  // namespace armwright::articulated
