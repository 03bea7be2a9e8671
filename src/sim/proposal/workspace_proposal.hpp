// Proposes a tracked orientation and a workspace for an arm of which only its file is known. The
// proposal depends on the model alone. Random draws come from streams with fixed names, so the same
// robot always gets the same proposal.
//
//   tool axis    the axis of the tip's frame that points away from the wrist; z if it does so, too
//   orientation  the first of these for which a workspace is found: the full orientation or the
//                direction of a tool that points down; the same, as the tool points at home; none.
//                Needs six joints or five that control it
//   home         one of 2000 random postures, in which the tool is turned down if it is to point
//                down. Only postures are tried that clear the floor and obstacles and that the
//                motors hold with 85 % of their effort limits; first those in front of the arm, and
//                of these the ones farthest from singularities and range ends. Taken is the one
//                around whose tip the largest sphere fits. The front is where the tip is on the
//                average over all postures, or x if that is nowhere
//   workspace    the sphere around the tip at home (a disc for arms that move in a plane), above
//                the floor and beside the arm's own base. On the straight moves of generated cases
//                the joints keep a distance from the ends of their ranges, the arm keeps away from
//                singularities, the links clear the floor and the task's obstacles, and the motors
//                hold the arm with 90 % of their limits. Collisions between links are checked only
//                if the task's clearance has them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/proposal/resting_arm.hpp"
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
// Does so for a joint that needs too much of its effort limit to hold the arm. `where` follows "to
// hold the arm".
[[noreturn]] void refuse_to_hold(const RobotModel& robot, const RestingArm::Hardest& hardest,
                                 const std::string& where);

// Returns the most complete orientation that the robot's joints can control.
ToolOrientation propose_orientation(const RobotModel& robot, const ToolTask& tool);
// Returns the axis that points: a unit vector along an axis of the tip's frame.
Eigen::Vector3d propose_tool_axis(const RobotModel& robot);

// A proposed home posture and the workspace around it.
struct WorkspaceProposal {
  std::vector<double> home;  // one position per joint
  ToolPose centre;           // of the tool at home
  WorkspaceSphere sphere;
  ToolOrientation orientation = ToolOrientation::free;
  bool points_down = false;  // the tool does at home, and its orientation is tracked
  std::optional<double> floor_m;
};
// Returns a proposal for a task. Uses `points` of `sphere`, and the task's floor, clearance and
// tool.axis; tool.turn need not be set. A task without floor gets one at height 0 if the arm stands
// above it and can work there. `orientation` is the one to track; nothing: the first possible one.
// Returns nothing if no place is found where the tool can move. Throws Error{bad_data} if the
// orientation is not possible, if the tip moves neither in space nor in a plane, and if the motors
// cannot hold the arm.
std::optional<WorkspaceProposal> propose_workspace(const RobotModel& robot, TrackingTask task,
                                                   const WorkspaceSphere& sphere,
                                                   std::optional<ToolOrientation> orientation);

// Returns the cases of kProposalSet in the sphere.
std::vector<TestCase> make_proposal_cases(const WorkspaceSphere& sphere);
// Makes the task cheaper for proposals: a control period of at least 10 ms and rests of at most 0.1
// s.
void coarsen(TrackingTask& task);

}  // namespace armwright
