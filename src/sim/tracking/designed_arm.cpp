#include "sim/tracking/designed_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

Inertial map_linearly(const Inertial& body, const Eigen::Matrix3d& map, double mass_factor) {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  // tr(I) = 2 tr(K), as I = tr(K) 1 - K.
  const Eigen::Matrix3d before = body.inertia_kg_m2.trace() / 2 * identity - body.inertia_kg_m2;
  const Eigen::Matrix3d after = mass_factor * (map * before * map.transpose());
  return {mass_factor * body.mass_kg, map * body.com_m, after.trace() * identity - after};
}

// Stretches a picture. Boxes, cylinders and spheres stay such: their edges are stretched and their
// angles kept.
void stretch_visual(VisualShape& visual, const Eigen::Matrix3d& map) {
  const Eigen::Vector3d factor = (map * visual.pose.linear()).colwise().norm();
  switch (visual.kind) {
    case ShapeKind::box:
    case ShapeKind::mesh:
      visual.size_m = visual.size_m.cwiseProduct(factor);
      break;
    case ShapeKind::cylinder:
      visual.size_m.x() *= std::sqrt(factor.x() * factor.y());
      visual.size_m.y() *= factor.z();
      break;
    case ShapeKind::sphere:
      visual.size_m.x() *= std::cbrt(factor.prod());
      break;
  }
  visual.pose.translation() = map * visual.pose.translation();
}

// Returns the map A of a link's points (designed_arm.hpp). `direction` is d.
Eigen::Matrix3d make_stretch(const Eigen::Vector3d& direction, double length_scale,
                             double section_scale) {
  const double across = std::sqrt(section_scale);
  return across * Eigen::Matrix3d::Identity() +
         (length_scale - across) * (direction * direction.transpose());
}

}  // namespace

RobotModel stretch_link(RobotModel model, std::size_t link, double length_scale,
                        double section_scale) {
  for (const double scale : {length_scale, section_scale}) {
    if (!std::isfinite(scale) || scale <= 0) {
      throw Error(ErrorKind::usage,
                  fmt::format("link '{}' is stretched by {}; it must be finite and > 0",
                              sanitize(model.links[link].name), scale));
    }
  }
  if (length_scale == 1 && section_scale == 1) {
    return model;
  }
  Eigen::Isometry3d& end = get_link_end(model, link);
  const double length_m = end.translation().norm();
  if (length_m == 0) {
    throw Error(ErrorKind::bad_data,
                fmt::format("robot '{}': link '{}' cannot be stretched: {} lies in its own joint, "
                            "which leaves no direction",
                            sanitize(model.name), sanitize(model.links[link].name),
                            link + 1 == model.joint_count() ? "the tip" : "the next joint"));
  }
  const Eigen::Vector3d direction = end.translation() / length_m;
  const Eigen::Matrix3d map = make_stretch(direction, length_scale, section_scale);
  Link& stretched = model.links[link];
  stretched.inertial = map_linearly(stretched.inertial, map, length_scale * section_scale);
  for (VisualShape& visual : stretched.visuals) {
    stretch_visual(visual, map);
  }
  end.translation() *= length_scale;
  return model;
}

RobotModel make_robot(const RobotModel& nominal, const ArmDesign& design,
                      double torque_per_mass_n_m_per_kg, const TubeMaterial& material) {
  RobotModel robot = nominal;
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    const JointDrive& its = design.joints[i];
    robot = stretch_link(std::move(robot), i, its.length_scale, its.section_scale);
    if (its.tube.diameter_m > 0) {
      make_tube(robot, i, its.tube, material);
    }
  }
  for (std::size_t i = 1; torque_per_mass_n_m_per_kg > 0 && i < design.joints.size(); ++i) {
    Inertial motor;
    motor.mass_kg = calc_largest_effort(design.joints[i]) / torque_per_mass_n_m_per_kg;
    motor.com_m = robot.joints[i].origin.translation();
    Inertial& carrier = robot.links[i - 1].inertial;
    carrier = combine(carrier, motor);
  }
  return robot;
}

TrackingTask make_task(TrackingTask nominal, const ArmDesign& design) {
  nominal.speed_m_per_s = design.speed_m_per_s.value_or(nominal.speed_m_per_s);
  return nominal;
}

std::shared_ptr<const ArmClearance> make_clearance(const ArmClearance& nominal,
                                                   const RobotModel& robot,
                                                   const ArmDesign& design) {
  std::vector<std::optional<Capsule>> capsules = nominal.capsules();
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    const JointDrive& its = design.joints[i];
    std::optional<Capsule>& capsule = capsules[i + 1];
    const bool is_tube = its.tube.diameter_m > 0;
    if (!is_tube && (!capsule || (its.length_scale == 1 && its.section_scale == 1))) {
      continue;
    }
    const Eigen::Vector3d end = get_link_end(robot, i).translation();
    if (is_tube) {
      capsule = Capsule{Eigen::Vector3d::Zero(), its.length_scale * end, its.tube.diameter_m / 2};
      continue;
    }
    const Eigen::Matrix3d map = make_stretch(end.normalized(), its.length_scale, its.section_scale);
    // The map makes an ellipsoid of a ball; its longest half axis is the radius.
    capsule = Capsule{map * capsule->from_m, map * capsule->to_m,
                      capsule->radius_m * std::max(its.length_scale, std::sqrt(its.section_scale))};
  }
  return std::make_shared<const ArmClearance>(nominal.with_capsules(std::move(capsules)));
}

bool is_stretched(const ArmDesign& design) {
  return std::ranges::any_of(design.joints, [](const JointDrive& joint) {
    return joint.length_scale != 1 || joint.section_scale != 1;
  });
}

bool has_tubes(const ArmDesign& design) {
  return std::ranges::any_of(design.joints,
                             [](const JointDrive& joint) { return joint.tube.diameter_m > 0; });
}

double calc_deflection_m(const RobotModel& nominal, const ArmDesign& design,
                         const TubeMaterial& material, double payload_kg, double gravity_m_per_s2) {
  std::vector<Tube> tubes;
  std::vector<double> lengths_m;
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    const JointDrive& its = design.joints[i];
    tubes.push_back(its.tube);
    lengths_m.push_back(its.length_scale * get_link_length_m(nominal, i));
  }
  return calc_deflection_m(tubes, lengths_m, material, payload_kg, gravity_m_per_s2);
}

double calc_moving_mass_kg(const RobotModel& model) {
  double mass_kg = 0;
  for (const Link& link : model.links) {
    mass_kg += link.inertial.mass_kg;
  }
  return mass_kg;
}

}  // namespace armwright
