// Proposes a speed, controllers and effort limits for an arm of which only the URDF is known. Its
// workspace must be chosen before (workspace_proposal.hpp).
//
//   speed        the longest move takes 1 s, or longer if necessary: joints stay below 60 % of
//                their speed limits. What inverse dynamics asks for beside gravity and dry friction
//                stays below 60 % of what these two leave of the effort limits
//   period       the longest of 10, 5, 2 and 1 ms at which the bound on D below reduces no gain
//   gains        m is the joint's largest M_ii, the diagonal element of the mass matrix, on the
//                cases; w is the bandwidth, z = 0.7, and h is the control period:
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

#include <span>
#include <vector>

#include "sim/tracking/design.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

// Returns a speed (m/s) for a task whose other members are set. Assumes that the arm rests at both
// ends of every move. Throws Error{bad_data} if gravity and dry friction alone take more than 95 % of
// a joint's effort limit; the message names the joint.
double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases);

// The bandwidth w of a proposed start, unless that is not stable.
inline constexpr double kStartBandwidth_rad_per_s = 10;
// In place of a bandwidth: the rule of version 1.0, which has this bandwidth too, but a control
// period of at least 10 ms in the bound on D.
inline constexpr double kStartOfVersion1 = 0;
// The time between two steps of the physics under a proposed control period.
inline constexpr double kProposedStep_s = 0.001;
inline constexpr double kShortestPeriod_s = 0.001;

// Returns the largest coupling (resting_arm.hpp) at which the bound on D reduces no gain.
double calc_most_coupling(double control_period_s);
// Returns a control period (s) for a task whose other members are set, except the speed.
double propose_period_s(const RobotModel& robot, TrackingTask task,
                        const std::vector<TestCase>& cases);

// Returns one design per bandwidth, each with one PID controller per joint. `own_limits`: whether the
// robot's own effort limits are proposed as they are. A bandwidth may be kStartOfVersion1.
std::vector<ArmDesign> propose_designs(const RobotModel& robot, TrackingTask task,
                                       const std::vector<TestCase>& cases, bool own_limits,
                                       std::span<const double> bandwidths_rad_per_s);

}  // namespace armwright
