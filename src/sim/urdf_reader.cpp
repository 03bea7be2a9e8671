#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <cassert>
#include <limits>
#include <mutex>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/urdf.hpp"

namespace armwright {
namespace {

// urdfdom explains itself through console_bridge only, whose handler is one for the whole process:
// ours collects the errors and keeps everything off the terminal.
class ErrorCollector final : public console_bridge::OutputHandler {
 public:
  ErrorCollector() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~ErrorCollector() override {
    if (previous_ != nullptr) {
      console_bridge::useOutputHandler(previous_);
    } else {
      console_bridge::noOutputHandler();
    }
  }
  ErrorCollector(const ErrorCollector&) = delete;
  ErrorCollector& operator=(const ErrorCollector&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
      errors_.push_back(sanitize(text));
    }
  }
  std::string text() const { return errors_.empty() ? "no reason given" : join(errors_, "; "); }

 private:
  console_bridge::OutputHandler* previous_;
  std::vector<std::string> errors_;
};

urdf::ModelInterfaceSharedPtr parse_with_urdfdom(const std::string& xml, const std::string& name) {
  static std::mutex one_handler;
  const std::lock_guard lock(one_handler);
  const ErrorCollector collector;
  std::string reason;
  try {
    if (auto model = urdf::parseURDF(xml)) {
      return model;
    }
    reason = collector.text();
  } catch (const std::exception& error) {
    reason = sanitize(error.what());
  }
  throw Error(ErrorKind::bad_data,
              fmt::format("{}: the URDF library refuses it: {}", name, reason));
}

Eigen::Vector3d to_eigen(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d to_eigen(const urdf::Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = to_eigen(pose.position);
  const urdf::Rotation& r = pose.rotation;
  result.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix();
  return result;
}

Inertial to_inertial(const urdf::Inertial& from) {
  Inertial body{from.mass, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  body.inertia_kg_m2 << from.ixx, from.ixy, from.ixz,  //
      from.ixy, from.iyy, from.iyz,                    //
      from.ixz, from.iyz, from.izz;
  return transform(body, to_eigen(from.origin));
}

VisualShape to_shape(const urdf::Visual& visual) {
  VisualShape shape;
  shape.pose = to_eigen(visual.origin);
  if (visual.material) {
    const urdf::Color& color = visual.material->color;
    shape.rgba = Eigen::Vector4d(color.r, color.g, color.b, color.a);
  }
  if (const auto* box = dynamic_cast<const urdf::Box*>(visual.geometry.get())) {
    shape.kind = ShapeKind::box;
    shape.size_m = to_eigen(box->dim);
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(visual.geometry.get())) {
    shape.kind = ShapeKind::cylinder;
    shape.size_m = Eigen::Vector3d(cylinder->radius, cylinder->length, 0);
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(visual.geometry.get())) {
    shape.kind = ShapeKind::sphere;
    shape.size_m = Eigen::Vector3d(sphere->radius, 0, 0);
  } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(visual.geometry.get())) {
    shape.kind = ShapeKind::mesh;
    shape.size_m = to_eigen(mesh->scale);
    shape.mesh_file = mesh->filename;
  }
  return shape;
}

// Adds a link's mass and looks to the link that carries it, in whose frame it has the pose `pose`.
void lump(const urdf::Link& from, const Eigen::Isometry3d& pose, Link& carrier) {
  if (from.inertial) {
    carrier.inertial = combine(carrier.inertial, transform(to_inertial(*from.inertial), pose));
  }
  for (const auto& visual : from.visual_array) {
    VisualShape shape = to_shape(*visual);
    shape.pose = pose * shape.pose;
    carrier.visuals.push_back(std::move(shape));
  }
}

Joint to_joint(const urdf::Joint& from, const Eigen::Isometry3d& parent_pose) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool continuous = from.type == urdf::Joint::CONTINUOUS;
  Joint joint;
  joint.name = from.name;
  joint.kind = from.type == urdf::Joint::PRISMATIC ? JointKind::prismatic : JointKind::revolute;
  joint.origin = parent_pose * to_eigen(from.parent_to_joint_origin_transform);
  joint.axis = to_eigen(from.axis).normalized();
  joint.lower = continuous ? -kInfinity : from.limits->lower;
  joint.upper = continuous ? kInfinity : from.limits->upper;
  joint.speed_limit = from.limits ? from.limits->velocity : kInfinity;
  joint.effort_limit = from.limits ? from.limits->effort : kInfinity;
  return joint;
}

}  // namespace

RobotModel build_model(const std::string& checked_xml, const std::string& name) {
  const urdf::ModelInterfaceSharedPtr from = parse_with_urdfdom(checked_xml, name);
  RobotModel model;
  model.name = from->getName();
  model.base.name = from->getRoot()->name;
  Link* carrier = &model.base;
  Eigen::Isometry3d pose =
      Eigen::Isometry3d::Identity();  // of the link at hand in its carrier's frame
  urdf::LinkConstSharedPtr link = from->getRoot();
  lump(*link, pose, *carrier);
  while (!link->child_links.empty()) {
    assert(link->child_links.size() == 1);
    link = link->child_links.front();
    const urdf::Joint& joint = *link->parent_joint;
    if (joint.type == urdf::Joint::FIXED) {
      pose = pose * to_eigen(joint.parent_to_joint_origin_transform);
    } else {
      model.joints.push_back(to_joint(joint, pose));
      carrier = &model.links.emplace_back();
      carrier->name = link->name;
      pose = Eigen::Isometry3d::Identity();
    }
    lump(*link, pose, *carrier);
  }
  model.tip_pose = pose;
  return model;
}

}  // namespace armwright
