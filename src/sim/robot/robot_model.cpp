#include "sim/robot/robot_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "sim/robot/mjcf.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

// Steiner's term: the inertia of a point mass at `r` from the reference point.
Eigen::Matrix3d calc_point_inertia(double mass_kg, const Eigen::Vector3d& r) {
  return mass_kg * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

// The thesis's load.
constexpr double kBlockEdge_m = 0.16825;
constexpr double kBlockThickness_m = 0.09;
// The size of a load of the user's own in pictures is that of a steel ball.
constexpr double kSteel_kg_per_m3 = 7850;

// Returns the direction of the block on the flange.
Eigen::Vector3d find_load_direction(const RobotModel& model) {
  const Eigen::Vector3d tip = model.tip_pose.translation();
  return tip.norm() == 0 ? model.joints.back().axis : Eigen::Vector3d(tip.normalized());
}

Inertial make_block(double mass_kg, const Eigen::Vector3d& tip, const Eigen::Vector3d& direction) {
  Inertial block;
  block.mass_kg = mass_kg;
  block.com_m = tip + kBlockThickness_m / 2 * direction;
  const double across =
      mass_kg / 12 * (kBlockEdge_m * kBlockEdge_m + kBlockThickness_m * kBlockThickness_m);
  const double along = mass_kg / 12 * (2 * kBlockEdge_m * kBlockEdge_m);
  block.inertia_kg_m2 =
      across * Eigen::Matrix3d::Identity() +
      (along - across) * (direction * direction.transpose());  // the base is square
  return block;
}

// Returns the inertia (kg m^2 or kg) that each joint moves at joint positions `q` if the others are
// held: the diagonal of the mass matrix, without armatures.
std::vector<double> calc_moved_inertias(const RobotModel& model, const std::vector<double>& q) {
  std::vector<double> inertias(model.joint_count());
  Inertial beyond;  // everything that the joint moves, in the frame of its link
  for (std::size_t i = model.joint_count(); i-- > 0;) {
    const Joint& joint = model.joints[i];
    beyond = combine(model.links[i].inertial, beyond);
    Eigen::Isometry3d pose = joint.origin;
    if (joint.kind == JointKind::prismatic) {
      inertias[i] = beyond.mass_kg;
      pose.translate(q[i] * joint.axis);
    } else {
      const double lever_m = joint.axis.cross(beyond.com_m).norm();
      inertias[i] =
          joint.axis.dot(beyond.inertia_kg_m2 * joint.axis) + beyond.mass_kg * lever_m * lever_m;
      pose.rotate(Eigen::AngleAxisd(q[i], joint.axis));
    }
    beyond = transform(beyond, pose);
  }
  return inertias;
}

std::vector<double> list_middles(const RobotModel& model) {
  std::vector<double> middles;
  for (const Joint& joint : model.joints) {
    const double middle = (joint.lower + joint.upper) / 2;
    middles.push_back(std::isfinite(middle) ? middle : 0);
  }
  return middles;
}

}  // namespace

Inertial combine(const Inertial& a, const Inertial& b) {
  if (a.mass_kg == 0 || b.mass_kg == 0) {
    return a.mass_kg == 0 ? b : a;  // unchanged to the last bit
  }
  Inertial sum;
  sum.mass_kg = a.mass_kg + b.mass_kg;
  sum.com_m = (a.mass_kg * a.com_m + b.mass_kg * b.com_m) / sum.mass_kg;
  sum.inertia_kg_m2 = a.inertia_kg_m2 + calc_point_inertia(a.mass_kg, a.com_m - sum.com_m) +
                      b.inertia_kg_m2 + calc_point_inertia(b.mass_kg, b.com_m - sum.com_m);
  return sum;
}

Inertial transform(const Inertial& body, const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& rotation = pose.linear();
  return {body.mass_kg, pose * body.com_m, rotation * body.inertia_kg_m2 * rotation.transpose()};
}

bool is_mjcf(std::string_view xml) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (xml.starts_with(kByteOrderMark)) {
    xml.remove_prefix(kByteOrderMark.size());
  }
  while (true) {
    xml.remove_prefix(std::min(xml.find_first_not_of(" \t\r\n"), xml.size()));
    const std::string_view end = xml.starts_with("<!--") ? "-->"
                                 : xml.starts_with("<?") ? "?>"
                                                         : "";
    if (end.empty()) {
      break;
    }
    const std::size_t at = xml.find(end);
    xml.remove_prefix(at == std::string_view::npos ? xml.size() : at + end.size());
  }
  constexpr std::string_view kRoot = "<mujoco";
  return xml.starts_with(kRoot) && xml.find_first_of(" \t\r\n/>", kRoot.size()) == kRoot.size();
}

namespace {

std::string read_urdf(const std::filesystem::path& file) {
  if (file.extension() == ".xacro") {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", file.string(), kXacroAdvice));
  }
  return read_file(file, kUrdfLimit_bytes);
}

}  // namespace

RobotModel load_urdf(const std::filesystem::path& file, const RobotOptions& options) {
  return parse_urdf(read_urdf(file), file.string(), options);
}

std::vector<CollisionShape> load_collisions(const std::filesystem::path& file) {
  return parse_collisions(read_urdf(file), file.string());
}

RobotModel parse_urdf(std::string_view xml, const std::string& name, const RobotOptions& options) {
  if (!std::isfinite(options.density_kg_per_m3) || options.density_kg_per_m3 < 0) {
    throw RobotOptionError("density_kg_per_m3",
                           fmt::format("{}: the density is {} kg/m3; it must be finite and > 0, or "
                                       "0 for none",
                                       name, options.density_kg_per_m3));
  }
  if (is_mjcf(xml)) {
    return parse_mjcf(xml, name, options);
  }
  UrdfFaults faults(name);
  const CheckedUrdf checked = check_urdf(xml, name, options, faults);
  RobotModel model = build_model(checked, name, options, faults);
  faults.throw_if_any();
  return model;
}

RobotModel add_load(RobotModel model, double mass_kg, const std::optional<LoadBody>& body) {
  if (!std::isfinite(mass_kg) || mass_kg < 0) {
    throw Error(ErrorKind::usage,
                fmt::format("the load is {} kg; it must be finite and >= 0", mass_kg));
  }
  if (mass_kg == 0) {
    return model;
  }
  Inertial load;
  VisualShape shape;
  if (body) {
    load = transform({mass_kg, body->com_m, mass_kg * body->inertia_m2}, model.tip_pose);
    shape.kind = ShapeKind::sphere;
    shape.size_m.x() = std::cbrt(3 * mass_kg / (4 * std::numbers::pi * kSteel_kg_per_m3));
    shape.pose.translation() = load.com_m;
  } else {
    const Eigen::Vector3d direction = find_load_direction(model);
    load = make_block(mass_kg, model.tip_pose.translation(), direction);
    shape.kind = ShapeKind::box;
    shape.size_m = Eigen::Vector3d(kBlockEdge_m, kBlockEdge_m, kBlockThickness_m);
    shape.pose.translation() = load.com_m;
    shape.pose.linear() =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction).toRotationMatrix();
  }
  shape.rgba = Eigen::Vector4d(0.45, 0.47, 0.50, 1.0);
  Link& last = model.links.back();
  last.inertial = combine(last.inertial, load);
  last.visuals.push_back(shape);
  return model;
}

bool RobotModel::has_plant() const {
  return std::ranges::any_of(joints, [](const Joint& joint) { return !joint.plant.is_ideal(); });
}

bool RobotModel::has_unactuated() const {
  return std::ranges::any_of(joints, [](const Joint& joint) { return joint.plant.unactuated; });
}

RobotModel scale_masses(RobotModel model, double factor) {
  if (!std::isfinite(factor) || factor <= 0) {
    throw Error(ErrorKind::usage,
                fmt::format("the masses' factor is {}; it must be finite and > 0", factor));
  }
  for (Link& link : model.links) {
    link.inertial.mass_kg *= factor;
    link.inertial.inertia_kg_m2 *= factor;
  }
  if (model.payload) {  // a part of the last link
    model.payload->mass_kg *= factor;
    model.payload->inertia_kg_m2 *= factor;
  }
  return model;
}

RobotModel scale_plants(RobotModel model, const PlantScales& scales) {
  constexpr double kSpringDamping = 0.05;
  const std::vector<double> inertias = calc_moved_inertias(model, list_middles(model));
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    JointPlant& plant = model.joints[i].plant;
    scale_friction(plant, scales.friction);
    if (plant.armature == 0 && !plant.unactuated) {
      plant.armature = scales.armature_share * inertias[i];
    }
    if (!plant.is_elastic() && !plant.unactuated && scales.elastic_hz > 0) {
      const double rate = 2 * std::numbers::pi * scales.elastic_hz;  // rad/s
      plant.stiffness = rate * rate * plant.armature;
      plant.damping = 2 * kSpringDamping * rate * plant.armature;
    }
    plant.armature *= scales.armature;
    scale_stiffness(plant, scales.stiffness);
  }
  return model;
}

}  // namespace armwright
