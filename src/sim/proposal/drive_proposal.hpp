// How fast to begin with an arm of which nothing is known but its URDF, and with what controllers
// and effort limits, once it is settled where it works (workspace_proposal.hpp).
//
//   speed        the longest move takes a second, or as long as it must: joints stay below 60 % of
//                their speed limits, and what inverse dynamics asks of them below 60 % of their
//                effort limits
//   gains        with m the largest M_ii of the mass matrix on the cases, w = 10 rad/s, z = 0.7 and
//                the control period h: D = 2 z w m, but at most 0.7 / (h max (M^-1)_ii), where
//                other joints give way (nearly coaxial ones, say); P = w^2 m, but at most D^2 / m;
//                I = P sqrt(P / m) / 4. Slow, but stable.
//   efforts      twice what inverse dynamics asks for at most, at least M_ii x 5 rad/s^2; where a
//                tenth of the joint's limit is more, that, but at most ten times as much; never
//                above the limit
#pragma once

#include <vector>

#include "sim/tracking/design.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

// Of a task in which all but the speed is settled, on moves that rest at their ends.
// Error{bad_data} names the joint that cannot even hold the arm.
double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases);

// A PID for each joint.
ArmDesign propose_design(const RobotModel& robot, TrackingTask task,
                         const std::vector<TestCase>& cases);

}  // namespace armwright
