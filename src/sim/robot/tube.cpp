#include "sim/robot/tube.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "base/decompositions.hpp"

namespace armwright {

using std::numbers::pi;

double Tube::section_m2() const {
  return pi / 4 * (diameter_m * diameter_m - bore_m() * bore_m());
}

double Tube::second_moment_m4() const {
  return pi / 64 * (std::pow(diameter_m, 4) - std::pow(bore_m(), 4));
}

Eigen::Isometry3d& get_link_end(RobotModel& robot, std::size_t link) {
  return link + 1 == robot.joint_count() ? robot.tip_pose : robot.joints[link + 1].origin;
}

const Eigen::Isometry3d& get_link_end(const RobotModel& robot, std::size_t link) {
  return link + 1 == robot.joint_count() ? robot.tip_pose : robot.joints[link + 1].origin;
}

double get_link_length_m(const RobotModel& robot, std::size_t link) {
  return get_link_end(robot, link).translation().norm();
}

void make_tube(RobotModel& robot, std::size_t link, const Tube& tube,
               const TubeMaterial& material) {
  const bool is_last = link + 1 == robot.joint_count();
  const Eigen::Vector3d end = get_link_end(robot, link).translation();
  const double length = end.norm();
  assert(length > 0);
  const double mass = material.density_kg_per_m3 * tube.section_m2() * length;
  const double squares = tube.diameter_m * tube.diameter_m + tube.bore_m() * tube.bore_m();
  const double across = mass * (length * length / 12 + squares / 16);
  const double along = mass * squares / 8;
  const Eigen::Vector3d axis = end / length;
  Link& made = robot.links[link];
  made.inertial = {
      mass, end / 2,
      across * Eigen::Matrix3d::Identity() + (along - across) * (axis * axis.transpose())};
  if (is_last && robot.payload) {
    made.inertial = combine(made.inertial, transform(*robot.payload, robot.tip_pose));
  }
  VisualShape shape;
  shape.kind = ShapeKind::cylinder;
  shape.size_m = {tube.diameter_m / 2, length, 0};
  shape.pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
  shape.pose.translation() = end / 2;
  made.visuals = {shape};
}

double calc_deflection_m(std::span<const Tube> tubes, std::span<const double> lengths_m,
                         const TubeMaterial& material, double payload_kg, double gravity_m_per_s2) {
  double deflection = 0;
  // From the tip inwards: the weight beyond a link's end, its moment about that end, and how long
  // the arm is from there.
  double force = payload_kg * gravity_m_per_s2, moment = 0, beyond = 0;
  for (std::size_t i = tubes.size(); i-- > 0;) {
    const double l = lengths_m[i];
    const double ei = material.youngs_modulus_pa * tubes[i].second_moment_m4();
    const double weight = material.density_kg_per_m3 * tubes[i].section_m2() * gravity_m_per_s2;
    const double way = (weight * l * l / 8 + force * l / 3 + moment / 2) * l * l / ei;
    const double turn = (weight * l * l / 6 + force * l / 2 + moment) * l / ei;
    deflection += way + turn * beyond;
    moment += force * l + weight * l * l / 2;
    force += weight * l;
    beyond += l;
  }
  return deflection;
}

}  // namespace armwright
