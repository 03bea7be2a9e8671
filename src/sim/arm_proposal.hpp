// What to begin with for an arm of which nothing is known but its URDF: which of the tool's
// orientation to track, where to work, how fast, and controllers and effort limits. All of it
// follows from the model; random draws come from streams of fixed names, so that the same robot
// always gets the same proposal.
//
//   orientation  all of it with six joints or more that can, else its direction with five, else
//                none
//   home         of 400 random postures the one about which the largest sphere can be worked in,
//                tried for those that are farthest from singularities and ends of ranges
//   workspace    the sphere about its tip (the disc, for arms that move in a plane), which keeps
//                off the first joint: on straight moves of generated cases joints stay off the ends
//                of their ranges and the arm off singularities. Collisions of links are not looked
//                for.
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

#include <string>
#include <vector>

#include "sim/tracking.hpp"

namespace armwright {

// Generated cases that proposals are made of and checked with; no problem trains or judges on them.
inline constexpr const char* kProposalSet = "proposal/1";

ToolOrientation propose_orientation(const RobotModel& robot, const ToolTask& tool);

struct WorkspaceProposal {
  std::vector<double> home;  // one position a joint
  ToolPose centre;           // of the tool at home
  WorkspaceSphere sphere;
};
// For a task whose tool.orientation is settled, but not how it is turned; sphere.points counts.
// Error{bad_data} if the robot can work nowhere, or its tip does not move in space or in a plane.
WorkspaceProposal propose_workspace(const RobotModel& robot, const TrackingTask& task,
                                    WorkspaceSphere sphere);

// Of a task in which all but the speed is settled, on moves that rest at their ends.
// Error{bad_data} names the joint that cannot even hold the arm.
double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases);

// A PID for each joint.
ArmDesign propose_design(const RobotModel& robot, TrackingTask task,
                         const std::vector<TestCase>& cases);
std::vector<TestCase> make_proposal_cases(const WorkspaceSphere& sphere);

}  // namespace armwright
