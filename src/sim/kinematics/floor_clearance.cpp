#include "sim/kinematics/floor_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armwright {
namespace {

constexpr int kHeightSamples = 8;
// A place whose height differs by less than this fraction of the arm's length does not move up or
// down.
constexpr double kNoHeight = 1e-6;

}  // namespace

double calc_arm_length_m(const RobotModel& robot) {
  double length_m = robot.tip_pose.translation().norm();
  for (std::size_t i = 1; i < robot.joint_count(); ++i) {
    length_m += robot.joints[i].origin.translation().norm();
  }
  for (const Joint& joint : robot.joints) {
    if (joint.kind == JointKind::prismatic && std::isfinite(joint.upper - joint.lower)) {
      length_m += joint.upper - joint.lower;
    }
  }
  return length_m;
}

FloorClearance::FloorClearance(const RobotModel& robot, const NumericKinematics& kinematics,
                               double floor_m)
    : kinematics_(kinematics) {
  const double length_m = calc_arm_length_m(robot);
  const std::size_t places = robot.joint_count() + 1;
  std::vector<double> least_m(places, std::numeric_limits<double>::infinity());
  std::vector<double> most_m(places, -std::numeric_limits<double>::infinity());
  RandomStream random("floor clearance/heights", 0);
  for (int sample = 0; sample < kHeightSamples; ++sample) {
    const std::vector<Eigen::Vector3d> at_m =
        kinematics.calc_places(kinematics.draw_posture(random));
    for (std::size_t i = 0; i < places; ++i) {
      least_m[i] = std::min(least_m[i], at_m[i].z());
      most_m[i] = std::max(most_m[i], at_m[i].z());
    }
  }
  for (std::size_t i = 0; i < places; ++i) {
    const bool moves = most_m[i] - least_m[i] > kNoHeight * length_m;
    const double radius_m = i + 1 < places ? kCapsuleOfLength * length_m : 0;
    allowed_m_.push_back(moves ? floor_m + radius_m : -std::numeric_limits<double>::infinity());
  }
}

FloorClearance::Lowest FloorClearance::find_lowest(std::span<const double> q) const {
  Lowest lowest;
  const std::vector<Eigen::Vector3d> at_m = kinematics_.calc_places(q);
  for (std::size_t i = 0; i < at_m.size(); ++i) {
    const double excess_m = allowed_m_[i] - at_m[i].z();
    if (excess_m > lowest.excess_m) {
      lowest = {i == 0 ? 0 : i - 1, at_m[i].z(), allowed_m_[i], excess_m};
    }
  }
  return lowest;
}

}  // namespace armwright
