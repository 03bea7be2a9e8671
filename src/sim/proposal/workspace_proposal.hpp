// Proposes a tracked orientation and a workspace for an arm of which only the URDF is known. The
// proposal depends on the model alone. Random draws come from streams with fixed names, so the same
// robot always gets the same proposal.
//
//   orientation  the full orientation if six or more joints can control it; the tool's direction
//                if five joints can; otherwise none
//   home         one of 400 random postures: the one around whose tip the largest sphere fits.
//                Only the postures farthest from singularities and range ends are tried.
//   workspace    the sphere around the tip at home (a disc for arms that move in a plane), at a
//                distance from the first joint. On the straight moves of generated cases the
//                joints keep a distance from the ends of their ranges and the arm from
//                singularities. Collisions of links are not checked.
#pragma once

#include <string>
#include <vector>

#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

// The set of generated cases with which proposals are made and checked. No problem uses it for
// training, validation or tests.
inline constexpr const char* kProposalSet = "proposal/1";
// The assumed duration of the longest move before a speed is proposed.
inline constexpr double kProposedMove_s = 1;

// Throws Error{bad_data} with the reason why nothing can be proposed for the robot.
[[noreturn]] void refuse_proposal(const RobotModel& robot, const std::string& what);

// Returns the most complete orientation that the robot's joints can control.
ToolOrientation propose_orientation(const RobotModel& robot, const ToolTask& tool);

// A proposed home posture and the workspace around it.
struct WorkspaceProposal {
  std::vector<double> home;  // one position a joint
  ToolPose centre;           // of the tool at home
  WorkspaceSphere sphere;
};
// Returns a proposal for a task whose tool.orientation is set; tool.turn need not be. Uses `points`
// of `sphere`. Throws Error{bad_data} if no workspace is found, or if the tip moves neither in
// space nor in a plane.
WorkspaceProposal propose_workspace(const RobotModel& robot, const TrackingTask& task,
                                    WorkspaceSphere sphere);

// Returns the cases of kProposalSet in the sphere.
std::vector<TestCase> make_proposal_cases(const WorkspaceSphere& sphere);
// Makes the task cheaper for proposals: a control period of at least 10 ms and rests of at most 0.1
// s.
void coarsen(TrackingTask& task);

}  // namespace armwright
