// The arm and the line of the least time's oracle: the facts that a test and a benchmark share.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <limits>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Joint 1 turns about z, joints 2 and 3 are horizontal; two slender rods of 1 m and 0.5 kg.
inline RobotModel make_line_arm() {
  RobotModel robot;
  robot.joints.resize(3);
  robot.links.resize(3);
  for (Joint& joint : robot.joints) {
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
  }
  robot.joints[1].axis = robot.joints[2].axis = -Eigen::Vector3d::UnitY();
  robot.joints[2].origin.translation() = robot.tip_pose.translation() = Eigen::Vector3d::UnitX();
  for (const std::size_t link : {1, 2}) {
    robot.links[link].inertial = {
        0.5, {0.5, 0, 0}, Eigen::Vector3d(0, 0.5 / 12, 0.5 / 12).asDiagonal()};
  }
  return robot;
}

// Returns the joint positions, elbow up, at the share s of the line from (1.2, -0.6, 0.4) to
// (1.2, 0.6, 0.8) m.
inline Eigen::VectorXd find_line_posture(double s) {
  const Eigen::Vector3d p(1.2, -0.6 + 1.2 * s, 0.4 + 0.4 * s);
  const double r = std::hypot(p.x(), p.y());
  const double elbow = -std::acos((r * r + p.z() * p.z()) / 2 - 1);
  Eigen::VectorXd q(3);
  q << std::atan2(p.y(), p.x()), std::atan2(p.z(), r) - elbow / 2, elbow;
  return q;
}

// Returns the joint positions at even shares of the line, one column per place.
inline Eigen::MatrixXd find_line_postures(std::size_t intervals) {
  Eigen::MatrixXd positions(3, static_cast<Eigen::Index>(intervals) + 1);
  for (std::size_t i = 0; i <= intervals; ++i) {
    positions.col(static_cast<Eigen::Index>(i)) =
        find_line_posture(static_cast<double>(i) / static_cast<double>(intervals));
  }
  return positions;
}

}  // namespace armwright
