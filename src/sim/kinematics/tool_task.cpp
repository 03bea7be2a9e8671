#include "sim/kinematics/tool_task.hpp"

#include <cmath>

namespace armwright {

const std::vector<std::string>& tool_orientation_names() {
  static const std::vector<std::string> names = {"free", "pointing", "pose"};
  return names;
}

std::vector<Eigen::Vector3d> make_tool_points(const ToolTask& tool) {
  switch (tool.orientation) {
    case ToolOrientation::free:
      break;
    case ToolOrientation::pointing:
      return {tool.arm_m * tool.axis, -tool.arm_m * tool.axis};
    case ToolOrientation::pose: {
      const double edge_m = tool.arm_m / std::sqrt(2.0);
      return {{edge_m, edge_m, edge_m},
              {edge_m, -edge_m, -edge_m},
              {-edge_m, edge_m, -edge_m},
              {-edge_m, -edge_m, edge_m}};
    }
  }
  return {};
}

Eigen::Matrix3d make_turn(const Eigen::Vector3d& rpy_rad) {
  return (Eigen::AngleAxisd(rpy_rad.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy_rad.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy_rad.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d calc_rpy(const Eigen::Matrix3d& turn) {
  const double across = std::hypot(turn(0, 0), turn(1, 0));
  const double pitch = std::atan2(-turn(2, 0), across);
  // At a pitch of +-pi/2 roll and yaw turn about the same axis. The whole turn counts as yaw.
  constexpr double kUpright = 1e-9;
  if (across < kUpright) {
    return {0, pitch, std::atan2(-turn(0, 1), turn(1, 1))};
  }
  return {std::atan2(turn(2, 1), turn(2, 2)), pitch, std::atan2(turn(1, 0), turn(0, 0))};
}

}  // namespace armwright
