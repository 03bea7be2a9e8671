// What of the tool's pose a task asks for, beside the tip's position, and how far off a pose is.
//
// With x the tip's position, R the orientation of its frame, x* and R* those of the target, and L
// what a turn by 1 rad counts like (m), the distance of two poses is
//   free      |x - x*|
//   pointing  sqrt(|x - x*|^2 + L^2 |R a - R* a|^2), a an axis of the tool: turns about it are free
//   pose      sqrt(|x - x*|^2 + L^2 |R - R*|_F^2 / 2), which for a turn by theta is
//             sqrt(|x - x*|^2 + (2 L sin(theta / 2))^2)
// This is the root mean square of how far points of the tool are from where they should be: two at
// +-L on the axis, or the corners of a regular tetrahedron about the tip whose circumscribed sphere
// has the radius L sqrt(3/2). So engines need no notion of orientation; and an error made of it
// sees every joint, those that only turn the tool included.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

enum class ToolOrientation { free, pointing, pose };
const std::vector<std::string>& tool_orientation_names();  // in the order of the enum

struct ToolTask {
  ToolOrientation orientation = ToolOrientation::free;
  // Of the tip's frame in the world, where a test case does not say it.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // pointing: unit vector in the tip's frame
  double arm_m = 0.1;                               // L
};

struct ToolPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
};

// Where the points whose distances are measured lie, from the tip and along its frame; none where
// the orientation is free.
std::vector<Eigen::Vector3d> make_tool_points(const ToolTask& tool);

// Roll, pitch, yaw as in URDF: Rz(yaw) Ry(pitch) Rx(roll); and back, pitch in [-pi/2, pi/2].
Eigen::Matrix3d make_turn(const Eigen::Vector3d& rpy_rad);
Eigen::Vector3d calc_rpy(const Eigen::Matrix3d& turn);

}  // namespace armwright
