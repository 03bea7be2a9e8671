// The start of an identification: least squares on the inverse dynamics, which are linear in
// friction, armature, counterbalance and the ten numbers of the last link (Gautier and Khalil 1990,
// Direct calculation of minimum set of inertial parameters of serial robots, IEEE Transactions on
// Robotics and Automation 6, 368-373).
#pragma once

#include <span>
#include <vector>

#include "problems/identification/identification_problem.hpp"

namespace armwright {

// The variables of an identification. Their boxes are wide: what the largest recorded effort would
// need if a single parameter had to explain it.
std::vector<DecisionVariable> make_boxes(const RobotModel& robot,
                                         std::span<const PlantParameter> parameters,
                                         std::span<const FittedMotion> motions);

// Returns how far the robot's own values may be off, one standard deviation per parameter; 0 where
// its files say nothing that counts: friction and offsets.
//   armature 30 %, counterbalance 0.2 of the scale and of the slope, Stribeck rate 100 %, a stated
//   payload 10 % and 0.05 m, numbers of inertia 0.3
Eigen::VectorXd list_priors(const RobotModel& robot, std::span<const PlantParameter> parameters);

// Sets the starts: those of the linear least squares, moved into the boxes. Parameters in which the
// model is not linear keep the robot's own values.
void set_linear_start(const IdentificationProblem& problem,
                      std::vector<DecisionVariable>& variables);

// Returns parameters after a few steps of Gauss and Newton from the starts, which by themselves can
// leave large residuals: a payload's has the ten numbers of the last link in its place, which take a
// part of what the last rotor explains. Optimizers that begin there were seen to end a standard error
// away from the minimum, in the flat valley of such pairs.
std::vector<double> fit_roughly(const IdentificationProblem& problem);

}  // namespace armwright
