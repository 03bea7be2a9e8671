// Proposes a speed, controllers and effort limits for an arm of which only the URDF is known. Its
// workspace must be chosen before (workspace_proposal.hpp).
//
//   speed        the longest move takes 1 s, or longer if necessary: joints stay below 60 % of
//                their speed limits, and the efforts of inverse dynamics below 60 % of their
//                effort limits
//   gains        m is the joint's largest M_ii, the diagonal element of the mass matrix, on the
//                cases; w = 10 rad/s, z = 0.7, and h is the control period:
//                  D = 2 z w m,          at most 0.7 / (h max (M^-1)_ii). This bound is the
//                                        smaller one if other joints move when this one is
//                                        driven, for example nearly coaxial joints
//                  P = w^2 m,            at most D^2 / m
//                  I = P sqrt(P / m) / 4
//                These gains are slow, but stable.
//   efforts      with e = max(2 x the largest effort of inverse dynamics, m x 5 rad/s^2) and the
//                joint's own limit L: L if `own_limits` is true and the robot has it, else
//                min(L, max(e, min(L / 10, 10 e)))
// Inverse dynamics and M_ii contain rotor inertia, friction and counterbalances.
#pragma once

#include <vector>

#include "sim/tracking/design.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

// Returns a speed (m/s) for a task whose other members are set. Assumes that the arm rests at both
// ends of every move. Throws Error{bad_data} if a joint cannot even hold the arm; the message names
// the joint.
double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases);

// Returns a design with one PID controller per joint. `own_limits`: whether the robot's own effort
// limits are proposed as they are.
ArmDesign propose_design(const RobotModel& robot, TrackingTask task,
                         const std::vector<TestCase>& cases, bool own_limits);

}  // namespace armwright
