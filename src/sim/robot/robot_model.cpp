#include "sim/robot/robot_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

// Steiner's term: the inertia of a point mass at `r` from the reference point.
Eigen::Matrix3d calc_point_inertia(double mass_kg, const Eigen::Vector3d& r) {
  return mass_kg * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
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

RobotModel load_urdf(const std::filesystem::path& file, const RobotOptions& options) {
  if (file.extension() == ".xacro") {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", file.string(), kXacroAdvice));
  }
  return parse_urdf(read_file(file, kUrdfLimit_bytes), file.string(), options);
}

RobotModel parse_urdf(std::string_view xml, const std::string& name, const RobotOptions& options) {
  if (!std::isfinite(options.density_kg_per_m3) || options.density_kg_per_m3 < 0) {
    throw RobotOptionError("density_kg_per_m3",
                           fmt::format("{}: the density is {} kg/m3; it must be finite and > 0, or "
                                       "0 for none",
                                       name, options.density_kg_per_m3));
  }
  return build_model(check_urdf(xml, name, options), name, options);
}

RobotModel add_load(RobotModel model, double mass_kg) {
  constexpr double kEdge_m = 0.16825;
  constexpr double kThickness_m = 0.09;
  if (!std::isfinite(mass_kg) || mass_kg < 0) {
    throw Error(ErrorKind::usage,
                fmt::format("the load is {} kg; it must be finite and >= 0", mass_kg));
  }
  if (mass_kg == 0) {
    return model;
  }
  const Eigen::Vector3d tip = model.tip_pose.translation();
  if (model.links.empty() || tip.norm() == 0) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format(
            "robot '{}' cannot carry a load: its tip is the origin of its last link, so the "
            "flange has no direction; add a link without mass on a fixed joint at the tip",
            sanitize(model.name)));
  }
  const Eigen::Vector3d direction = tip.normalized();

  Inertial block;
  block.mass_kg = mass_kg;
  block.com_m = tip + kThickness_m / 2 * direction;
  const double across = mass_kg / 12 * (kEdge_m * kEdge_m + kThickness_m * kThickness_m);
  const double along = mass_kg / 12 * (2 * kEdge_m * kEdge_m);
  block.inertia_kg_m2 =
      across * Eigen::Matrix3d::Identity() +
      (along - across) * (direction * direction.transpose());  // the base is square

  VisualShape shape;
  shape.kind = ShapeKind::box;
  shape.size_m = Eigen::Vector3d(kEdge_m, kEdge_m, kThickness_m);
  shape.pose.translation() = block.com_m;
  shape.pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction).toRotationMatrix();
  shape.rgba = Eigen::Vector4d(0.45, 0.47, 0.50, 1.0);

  Link& last = model.links.back();
  last.inertial = combine(last.inertial, block);
  last.visuals.push_back(shape);
  return model;
}

bool RobotModel::has_plant() const {
  return std::ranges::any_of(joints, [](const Joint& joint) { return !joint.plant.is_ideal(); });
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
  return model;
}

}  // namespace armwright
