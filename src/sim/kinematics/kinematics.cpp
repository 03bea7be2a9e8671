#include "sim/kinematics/kinematics.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kJoints = 4;

// Deviations from the ideal geometry up to this size (m or rad) count as rounding in the robot's
// file.
constexpr double kGeometryTolerance = 1e-6;

// These functions avoid atan2 and hypot of libm, whose last bits depend on libm's version.
double calc_elevation(const Eigen::Vector3d& v) {
  return targets::calc_angle(v.z(), v.x());
}
double calc_length(const Eigen::Vector3d& v) {
  return std::sqrt(v.x() * v.x() + v.z() * v.z());
}

// Returns the pose of the link that the joint at q moves, given the pose of the link that carries
// the joint.
Eigen::Isometry3d calc_next_pose(const Eigen::Isometry3d& pose, const Joint& joint, double q) {
  if (joint.kind == JointKind::prismatic) {
    return pose * joint.origin * Eigen::Translation3d(q * joint.axis);
  }
  return pose * joint.origin * Eigen::AngleAxisd(q, joint.axis);
}

std::string describe(const Eigen::Vector3d& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z());
}

[[noreturn]] void refuse(const RobotModel& model, const std::string& what) {
  throw Error(ErrorKind::bad_data,
              fmt::format("robot '{}' does not suit the closed-form inverse kinematics: {}",
                          sanitize(model.name), what));
}

// Returns +1 if the axis is `expected` in the world, or -1 if it is the opposite. Throws
// Error{bad_data} otherwise.
double find_axis_sign(const RobotModel& model, std::size_t joint, const Eigen::Isometry3d& pose,
                      const Eigen::Vector3d& expected, std::string_view expected_name) {
  const Eigen::Vector3d axis = pose.linear() * model.joints[joint].axis;
  for (const double sign : {1.0, -1.0}) {
    if ((axis - sign * expected).norm() < kGeometryTolerance) {
      return sign;
    }
  }
  refuse(model,
         fmt::format(
             "at angle zero the axis of joint {} ('{}') is {} in the world frame; it must be {}",
             joint + 1, sanitize(model.joints[joint].name), describe(axis), expected_name));
}

}  // namespace

double wrap_angle(double angle_rad) {
  if (std::abs(angle_rad) <= kPi) {
    return angle_rad;  // the computation below gives the same value at a higher cost
  }
  return std::remainder(angle_rad, 2 * kPi);
}

double calc_displacement(JointKind kind, double from, double to) {
  return kind == JointKind::prismatic ? to - from : wrap_angle(to - from);
}

std::vector<Eigen::Isometry3d> calc_link_poses(const RobotModel& model, std::span<const double> q) {
  assert(q.size() == model.joint_count());
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(model.joint_count());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    pose = calc_next_pose(pose, model.joints[i], q[i]);
    poses.push_back(pose);
  }
  return poses;
}

Eigen::Vector3d calc_tip_position(const RobotModel& model, std::span<const double> q) {
  assert(q.size() == model.joint_count());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    pose = calc_next_pose(pose, model.joints[i], q[i]);
  }
  return pose * model.tip_pose.translation();
}

ElbowUpKinematics::ElbowUpKinematics(const RobotModel& model, bool ik_bug) {
  if (model.joint_count() != kJoints) {
    refuse(model, fmt::format(
                      "it has {} moving joints; it must have {}: a vertical one and three parallel "
                      "horizontal ones",
                      model.joint_count(), kJoints));
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (model.joints[i].kind == JointKind::prismatic) {
      refuse(model, fmt::format("joint {} ('{}') is prismatic; all {} must be revolute", i + 1,
                                sanitize(model.joints[i].name), kJoints));
    }
  }
  const std::array<double, kJoints> zero{};
  const std::vector<Eigen::Isometry3d> poses = calc_link_poses(model, zero);
  arm_.sign[0] = find_axis_sign(model, 0, poses[0], Eigen::Vector3d::UnitZ(), "vertical, +z or -z");
  for (std::size_t i = 1; i < kJoints; ++i) {
    arm_.sign[i] = find_axis_sign(model, i, poses[i], Eigen::Vector3d::UnitY(), "+y or -y");
  }
  const Eigen::Vector3d first = poses[0].translation();
  if (first.head<2>().norm() > kGeometryTolerance) {
    refuse(model,
           fmt::format(
               "joint 1 ('{}') turns about the vertical through x = {:.6g}, y = {:.6g} m; it must "
               "be the z axis of the base link's frame: move that frame onto the axis",
               sanitize(model.joints[0].name), first.x(), first.y()));
  }
  const Eigen::Vector3d tip = poses[3] * model.tip_pose.translation();
  if (std::abs(tip.y()) > kGeometryTolerance) {
    refuse(model,
           fmt::format(
               "at angle zero its tip is at y = {:.6g} m; the links must lead it back into the "
               "vertical plane y = 0 through the first axis",
               tip.y()));
  }

  const Eigen::Vector3d shoulder = poses[1].translation();
  const Eigen::Vector3d upper_arm = poses[2].translation() - shoulder;
  const Eigen::Vector3d forearm = poses[3].translation() - poses[2].translation();
  const Eigen::Vector3d last_link = tip - poses[3].translation();
  arm_.shoulder_radius_m = shoulder.x();
  arm_.shoulder_height_m = shoulder.z();
  arm_.upper_arm_m = calc_length(upper_arm);
  arm_.forearm_m = calc_length(forearm);
  arm_.last_link_m = calc_length(last_link);
  arm_.upper_arm_zero_rad = calc_elevation(upper_arm);
  arm_.forearm_zero_rad = calc_elevation(forearm);
  arm_.last_link_zero_rad = calc_elevation(last_link);
  arm_.shoulder_offset_m = ik_bug ? kIkBugOffset_m : 0;

  const std::array<double, 3> lengths{arm_.upper_arm_m, arm_.forearm_m, arm_.last_link_m};
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] < kGeometryTolerance) {
      refuse(model, fmt::format("link '{}' has no length: {} lies on the axis of joint {} ('{}')",
                                sanitize(model.links[i + 1].name),
                                i + 2 < kJoints ? fmt::format("joint {} ('{}')", i + 3,
                                                              sanitize(model.joints[i + 2].name))
                                                : "the tip",
                                i + 2, sanitize(model.joints[i + 1].name)));
    }
  }
}

std::optional<ElbowUpKinematics> ElbowUpKinematics::make_if_suited(const RobotModel& model,
                                                                   bool ik_bug) {
  try {
    return ElbowUpKinematics(model, ik_bug);
  } catch (const Error&) {  // the reason is not needed here
    return std::nullopt;
  }
}

bool ElbowUpKinematics::solve(const Eigen::Vector3d& target_m, std::span<double, 4> q) const {
  return targets::solve(arm_, target_m.data(), q.data());
}

std::string ask_millimetres(double distance_m, double reach_m) {
  constexpr double kImplausible = 10;
  return distance_m > kImplausible * reach_m ? "; were millimetres meant? All lengths are in metres"
                                             : "";
}

std::string ElbowUpKinematics::describe_unreachable(const Eigen::Vector3d& target_m) const {
  const double distance_m = targets::calc_wrist_distance(arm_, target_m.data());
  const double reach_m = arm_.upper_arm_m + arm_.forearm_m;
  return fmt::format(
      "target {} m is out of reach: the wrist would be {:.6g} m from the shoulder, possible is "
      "{:.6g} to {:.6g} m{}",
      describe(target_m), distance_m, std::abs(arm_.upper_arm_m - arm_.forearm_m), reach_m,
      ask_millimetres(distance_m, reach_m));
}

}  // namespace armwright
