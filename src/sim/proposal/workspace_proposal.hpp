// Where to begin with an arm of which nothing is known but its URDF: which of the tool's
// orientation to track, and where to work. All of it follows from the model; random draws come from
// streams of fixed names, so that the same robot always gets the same proposal.
//
//   orientation  all of it with six joints or more that can, else its direction with five, else
//                none
//   home         of 400 random postures the one about which the largest sphere can be worked in,
//                tried for those that are farthest from singularities and ends of ranges
//   workspace    the sphere about its tip (the disc, for arms that move in a plane), which keeps
//                off the first joint: on straight moves of generated cases joints stay off the ends
//                of their ranges and the arm off singularities. Collisions of links are not looked
//                for.
#pragma once

#include <string>
#include <vector>

#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

// Generated cases that proposals are made of and checked with; no problem trains or judges on them.
inline constexpr const char* kProposalSet = "proposal/1";
// What the longest move takes, before anything is known of speeds.
inline constexpr double kProposedMove_s = 1;

// Throws Error{bad_data}: why nothing can be proposed for the robot.
[[noreturn]] void refuse_proposal(const RobotModel& robot, const std::string& what);

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

std::vector<TestCase> make_proposal_cases(const WorkspaceSphere& sphere);
// However fine the control and however long the rests, a proposal looks at its cases every 10 ms,
// and at rests no longer than it takes.
void coarsen(TrackingTask& task);

}  // namespace armwright
