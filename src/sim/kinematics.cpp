#include "sim/kinematics.hpp"

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

// Deviations of a robot from the ideal that are only its file's rounding: a micrometre, a
// microradian.
constexpr double kGeometryTolerance = 1e-6;

double calc_elevation(const Eigen::Vector3d& v) {
  return std::atan2(v.z(), v.x());
}
double calc_length(const Eigen::Vector3d& v) {
  return std::hypot(v.x(), v.z());
}

// The pose of the link that a joint at q moves, from the pose of the link that carries the joint.
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

// +1 or -1 where the axis is `expected` or its opposite in the world.
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
    return angle_rad;  // exactly what the division below yields, without its cost
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

ElbowUpKinematics::ElbowUpKinematics(const RobotModel& model, bool ik_bug) : ik_bug_(ik_bug) {
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
  sign_[0] = find_axis_sign(model, 0, poses[0], Eigen::Vector3d::UnitZ(), "vertical, +z or -z");
  for (std::size_t i = 1; i < kJoints; ++i) {
    sign_[i] = find_axis_sign(model, i, poses[i], Eigen::Vector3d::UnitY(), "+y or -y");
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
  shoulder_radius_m_ = shoulder.x();
  shoulder_height_m_ = shoulder.z();
  upper_arm_m_ = calc_length(upper_arm);
  forearm_m_ = calc_length(forearm);
  last_link_m_ = calc_length(last_link);
  upper_arm_zero_rad_ = calc_elevation(upper_arm);
  forearm_zero_rad_ = calc_elevation(forearm);
  last_link_zero_rad_ = calc_elevation(last_link);

  const std::array<double, 3> lengths{upper_arm_m_, forearm_m_, last_link_m_};
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

ElbowUpKinematics::Wrist ElbowUpKinematics::calc_wrist(const Eigen::Vector3d& target_m) const {
  Wrist wrist{};
  wrist.heading_rad = std::atan2(target_m.y(), target_m.x());
  wrist.up_m = target_m.z() + last_link_m_ - shoulder_height_m_;
  if (ik_bug_) {
    const double cosine = std::cos(wrist.heading_rad);
    const double sine = std::sin(wrist.heading_rad);
    const double shoulder_x = shoulder_radius_m_ * cosine + kIkBugOffset_m * sine;
    const double shoulder_y = shoulder_radius_m_ * sine - kIkBugOffset_m * cosine;
    wrist.forward_m = std::hypot(target_m.x() - shoulder_x, target_m.y() - shoulder_y);
  } else {
    wrist.forward_m = std::hypot(target_m.x(), target_m.y()) - shoulder_radius_m_;
  }
  wrist.distance_m = std::hypot(wrist.up_m, wrist.forward_m);
  return wrist;
}

bool ElbowUpKinematics::solve(const Eigen::Vector3d& target_m, std::span<double, 4> q) const {
  const Wrist wrist = calc_wrist(target_m);
  const double a = forearm_m_;
  const double b = wrist.distance_m;
  const double c = upper_arm_m_;
  const double cos_beta = (b * b + c * c - a * a) / (2 * b * c);
  const double cos_gamma = (a * a + c * c - b * b) / (2 * a * c);
  if (!(std::abs(cos_beta) <= 1) || !(std::abs(cos_gamma) <= 1)) {
    return false;  // the negations catch a NaN: a wrist in the shoulder, a target that is no number
  }
  const double upper_arm_elevation = std::atan2(wrist.up_m, wrist.forward_m) + std::acos(cos_beta);
  const double forearm_elevation = upper_arm_elevation - (kPi - std::acos(cos_gamma));
  constexpr double kLastLinkElevation = -kPi / 2;

  // A positive rotation about +y tips a link down, so the angles of joints 2 to i add up to its
  // elevation at angle zero less the one it is to have.
  const double q2 = upper_arm_zero_rad_ - upper_arm_elevation;
  const double q23 = forearm_zero_rad_ - forearm_elevation;
  const double q234 = last_link_zero_rad_ - kLastLinkElevation;
  q[0] = sign_[0] * wrist.heading_rad;
  q[1] = sign_[1] * q2;
  q[2] = sign_[2] * (q23 - q2);
  q[3] = sign_[3] * (q234 - q23);
  return true;
}

std::string ElbowUpKinematics::describe_unreachable(const Eigen::Vector3d& target_m) const {
  return fmt::format(
      "target {} m is out of reach: the wrist would be {:.6g} m from the shoulder, possible is "
      "{:.6g} to {:.6g} m",
      describe(target_m), calc_wrist(target_m).distance_m, std::abs(upper_arm_m_ - forearm_m_),
      upper_arm_m_ + forearm_m_);
}

}  // namespace armwright
