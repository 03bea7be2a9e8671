// The part of the tool's pose that a task tracks beside the tip's position, and the distance
// between two poses.
//
// Let x be the tip's position, R the orientation of its frame, x* and R* those of the target. L is
// the length (m) that is equivalent to a turn by 1 rad. The distance of the two poses is
//   free      |x - x*|
//   pointing  sqrt(|x - x*|^2 + L^2 |R a - R* a|^2), a an axis of the tool; turns about it are free
//   pose      sqrt(|x - x*|^2 + L^2 |R - R*|_F^2 / 2), which for a turn by theta is
//             sqrt(|x - x*|^2 + (2 L sin(theta / 2))^2)
// This equals the root mean square distance of the tool's points from their targets. For `pointing`
// these are two points at +-L on the axis. For `pose` they are the corners of a regular tetrahedron
// around the tip whose circumscribed sphere has the radius L sqrt(3/2). So engines measure points
// only and need no orientation. The error also depends on joints that only turn the tool.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "sim/kinematics/posture_solver.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// Returns the names in the order of ToolOrientation.
const std::vector<std::string>& tool_orientation_names();

// How a task treats the tool's orientation.
struct ToolTask {
  ToolOrientation orientation = ToolOrientation::free;
  // The target orientation of the tip's frame in the world, for test cases that give none.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // pointing: unit vector in the tip's frame
  double arm_m = 0.1;                               // L
};

// The position and orientation of the tip's frame in the world.
struct ToolPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
};

// Returns the points whose distances are measured (m), relative to the tip, in the tip's frame.
// Returns none if the orientation is free.
std::vector<Eigen::Vector3d> make_tool_points(const ToolTask& tool);

// make_turn() returns the rotation Rz(yaw) Ry(pitch) Rx(roll), as in URDF. calc_rpy() returns roll,
// pitch and yaw of a rotation, with the pitch in [-pi/2, pi/2].
Eigen::Matrix3d make_turn(const Eigen::Vector3d& rpy_rad);
Eigen::Vector3d calc_rpy(const Eigen::Matrix3d& turn);

}  // namespace armwright
