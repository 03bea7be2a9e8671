#include "sim/robot/assumed_mass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.hpp"

namespace armwright {
namespace {

constexpr double kThicknessAtBase = 1.0 / 7,
                 kThicknessAtTip = 1.0 / 14;  // shares of the arm's length
constexpr double kShortestArm_m = 1e-3, kLongestArm_m = 1e3;
constexpr double kGravity_m_per_s2 = 9.81;
// Effort limits that leave less of the assumed masses are placeholders.
constexpr double kLeastFactor = 0.01;

// Returns the vectors from each joint to the next one or to the tip, at position 0.
std::vector<Eigen::Vector3d> list_ways(const RobotModel& robot) {
  std::vector<Eigen::Vector3d> ways;
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    ways.push_back(i + 1 < robot.joint_count() ? robot.joints[i + 1].origin.translation()
                                               : robot.tip_pose.translation());
  }
  return ways;
}

Inertial make_cylinder_along(const Eigen::Vector3d& way, const Eigen::Vector3d& axis,
                             double diameter_m) {
  const double way_m = way.norm();
  const double length_m = std::max(way_m, diameter_m);
  const Eigen::Vector3d along = way_m > 0 ? Eigen::Vector3d(way / way_m) : axis;
  const double square_m2 = diameter_m * diameter_m / 4;
  Inertial body;
  body.mass_kg = kRepairDensity_kg_per_m3 * std::numbers::pi * square_m2 * length_m;
  body.com_m = way / 2;
  const double across = body.mass_kg / 12 * (3 * square_m2 + length_m * length_m);
  const double about = body.mass_kg / 2 * square_m2;
  body.inertia_kg_m2 =
      across * Eigen::Matrix3d::Identity() + (about - across) * (along * along.transpose());
  return body;
}

// Returns whether each joint carries weight in some posture: it is not vertical, or a joint before
// it can tilt it.
std::vector<bool> find_loaded_joints(const RobotModel& robot) {
  std::vector<bool> loaded;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  bool is_upright = true;
  for (const Joint& joint : robot.joints) {
    turn = turn * joint.origin.linear();
    constexpr double kRounding = 1e-6;
    const double vertical = std::abs((turn * joint.axis).z());
    const bool slides = joint.kind == JointKind::prismatic;
    const bool is_vertical = vertical > 1 - kRounding;
    loaded.push_back(!is_upright || (slides ? vertical > kRounding : !is_vertical));
    is_upright = is_upright && (slides || is_vertical);
  }
  return loaded;
}

// Returns the factor on the assumed masses that leaves gravity its share of the effort limits.
double calc_factor(const RobotModel& robot, const std::vector<Eigen::Vector3d>& ways,
                   const std::vector<bool>& is_assumed) {
  double factor = 1;
  const std::vector<bool> loaded = find_loaded_joints(robot);
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joints[i];
    if (!std::isfinite(joint.effort_limit) || !loaded[i]) {
      continue;
    }
    double stated = 0, assumed = 0;  // N m, or N of a joint that slides
    double distance_m = 0;           // of joint k from joint i in the stretched arm
    for (std::size_t k = i; k < robot.joint_count(); ++k) {
      const Inertial& body = robot.links[k].inertial;
      const double lever = joint.kind == JointKind::prismatic ? 1 : distance_m + body.com_m.norm();
      (is_assumed[k] ? assumed : stated) += kGravity_m_per_s2 * body.mass_kg * lever;
      distance_m += ways[k].norm();
    }
    if (assumed > 0) {
      factor = std::min(factor, (kMostGravityShare * joint.effort_limit - stated) / assumed);
    }
  }
  return std::max(factor, kLeastFactor);
}

}  // namespace

std::vector<std::size_t> assume_masses(RobotModel& robot, std::vector<std::string>& notes) {
  const std::vector<Eigen::Vector3d> ways = list_ways(robot);
  double length_m = 0;
  for (const Eigen::Vector3d& way : ways) {
    length_m += way.norm();
  }
  if (!(length_m > kShortestArm_m && length_m < kLongestArm_m)) {
    return {};  // such a length does not say how heavy the arm is
  }
  std::vector<bool> is_assumed(ways.size());
  std::vector<std::size_t> links;
  double left_m = length_m;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double beyond_m = std::max(left_m, 0.0);  // roundings may leave less than nothing
    left_m -= ways[i].norm();
    if (robot.links[i].inertial.mass_kg > 0) {
      continue;
    }
    const double diameter_m =
        kThicknessAtTip * length_m + (kThicknessAtBase - kThicknessAtTip) * beyond_m;
    robot.links[i].inertial = make_cylinder_along(ways[i], robot.joints[i].axis, diameter_m);
    is_assumed[i] = true;
    links.push_back(i);
  }
  if (links.empty()) {
    return links;
  }
  const double factor = calc_factor(robot, ways, is_assumed);
  std::vector<std::string> masses;
  for (const std::size_t i : links) {
    Inertial& body = robot.links[i].inertial;
    body.mass_kg *= factor;
    body.inertia_kg_m2 *= factor;
    masses.push_back(fmt::format("'{}' {:.3g} kg", robot.links[i].name, body.mass_kg));
  }
  notes.push_back(fmt::format(
      "moving links for which the file states no mass: {} of {}. Their masses are assumed, and all "
      "results depend on them; state <inertial> elements, or set robot.density_kg_per_m3 to take "
      "masses from shapes",
      links.size(), robot.joint_count()));
  notes.push_back(fmt::format(
      "assumed masses: {}. Each link is a solid cylinder of {} kg/m3 from its joint to the next, "
      "{:.3g} m thick where the arm begins and {:.3g} m at the tip (1/7 and 1/14 of its length of "
      "{:.3g} m){}",
      join(masses, ", "), kRepairDensity_kg_per_m3, kThicknessAtBase * length_m,
      kThicknessAtTip * length_m, length_m,
      factor < 1 ? fmt::format(", times {:.3g}, so that gravity takes at most {:g} % of the effort "
                               "limits",
                               factor, 100 * kMostGravityShare)
                 : ""));
  return links;
}

}  // namespace armwright
