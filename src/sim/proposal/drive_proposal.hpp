// Proposes a speed, controllers and effort limits for an arm of which only the URDF is known. Its
// workspace must be chosen before (workspace_proposal.hpp).
//
//   speed        the longest move takes 1 s, or longer if necessary: joints stay below 60 % of
//                their speed limits, and the efforts of inverse dynamics below 60 % of their
//                effort limits
//   gains        m is the largest M_ii of the mass matrix on the cases, w = 10 rad/s, z = 0.7, and
//                h is the control period:
//                  D = 2 z w m,          at most 0.7 / (h max (M^-1)_ii), which matters if other
//                                        joints yield, for example nearly coaxial ones
//                  P = w^2 m,            at most D^2 / m
//                  I = P sqrt(P / m) / 4
//                These gains are slow, but stable.
//   efforts      e = twice the largest effort of inverse dynamics, at least M_ii x 5 rad/s^2. If
//                a tenth of the joint's limit is larger than e, that tenth, but at most 10 e.
//                Never above the joint's limit.
#pragma once

#include <vector>

#include "sim/tracking/design.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

// Returns a speed (m/s) for a task whose other members are set; the cases' moves rest at their
// ends. Throws Error{bad_data} if a joint cannot even hold the arm; the message names the joint.
double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases);

// Returns a design with one PID controller per joint.
ArmDesign propose_design(const RobotModel& robot, TrackingTask task,
                         const std::vector<TestCase>& cases);

}  // namespace armwright
