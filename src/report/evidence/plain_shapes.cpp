// Makes plain shapes for the links of a robot that has no meshes.

#include <algorithm>
#include <cmath>

#include "base/decompositions.hpp"
#include "report/evidence/robot_scene.hpp"

namespace armwright {
namespace {

const Eigen::Vector4d kTube(0.66, 0.68, 0.71, 1.0);
const Eigen::Vector4d kDrum(0.35, 0.37, 0.40, 1.0);

// Returns the end of the body in the body's frame: the next joint, or the tip.
Eigen::Vector3d find_end(const RobotModel& model, std::size_t body) {
  return body < model.joints.size() ? model.joints[body].origin.translation()
                                    : model.tip_pose.translation();
}

}  // namespace

VisualShape make_ball(const Eigen::Vector3d& centre, double radius, const Eigen::Vector4d& rgba) {
  VisualShape shape;
  shape.kind = ShapeKind::sphere;
  shape.size_m = Eigen::Vector3d(radius, 0, 0);
  shape.pose.translation() = centre;
  shape.rgba = rgba;
  return shape;
}

VisualShape make_cylinder(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
                          const Eigen::Vector4d& rgba) {
  VisualShape shape;
  shape.kind = ShapeKind::cylinder;
  shape.size_m = Eigen::Vector3d(radius, (to - from).norm(), 0);
  shape.pose.translation() = (from + to) / 2;
  shape.pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from).toRotationMatrix();
  shape.rgba = rgba;
  return shape;
}

std::vector<std::vector<VisualShape>> make_plain_shapes(const RobotModel& model) {
  const std::size_t count = model.joints.size() + 1;
  double length = 0;
  for (std::size_t body = 0; body < count; ++body) {
    length += find_end(model, body).norm();
  }
  const double scale = length > 0 ? length : 1;

  std::vector<std::vector<VisualShape>> bodies(count);
  for (std::size_t body = 0; body < count; ++body) {
    std::vector<VisualShape>& shapes = bodies[body];
    const double radius =
        scale * (0.035 - 0.020 * static_cast<double>(body) / static_cast<double>(count));
    const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    const Eigen::Vector3d end = find_end(model, body);
    shapes.push_back(make_ball(origin, radius, kTube));
    if (end.norm() > radius / 10) {
      shapes.push_back(make_cylinder(origin, end, radius, kTube));
      shapes.push_back(make_ball(end, radius, kTube));
    }
    if (body == 0) {
      continue;
    }
    const Joint& joint = model.joints[body - 1];
    if (joint.kind == JointKind::revolute) {
      const Eigen::Vector3d half = 1.3 * radius * joint.axis;
      shapes.push_back(make_cylinder(-half, half, 1.25 * radius, kDrum));
    } else if (std::isfinite(joint.upper) && joint.upper > 0) {
      // The rod reaches back to the place of the body at joint position 0.
      const double reach = std::min(joint.upper, scale);
      shapes.push_back(make_cylinder(-reach * joint.axis, origin, 0.7 * radius, kDrum));
    }
  }
  return bodies;
}

}  // namespace armwright
