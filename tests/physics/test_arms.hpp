// Arms of general shape for the physics tests (no zeros, no symmetry), and driving an OdeArm.
#pragma once

#include <Eigen/Dense>
#include <numbers>
#include <string>
#include <vector>

#include "chain_oracle.hpp"
#include "sim/kinematics.hpp"
#include "sim/ode_arm.hpp"
#include "sim/robot_model.hpp"

namespace armwright::physics_test {

constexpr double kPi = std::numbers::pi;
constexpr double kGravity_m_per_s2 = 9.80665;

// A general inertia tensor from principal moments (which must satisfy the triangle inequality) and
// the body's turned principal axes.
inline Matrix3d make_inertia(const Vector3d& principal_kg_m2, const Vector3d& turn_rad) {
  const Matrix3d axes = make_rotation(turn_rad.normalized(), turn_rad.norm());
  return axes * principal_kg_m2.asDiagonal() * axes.transpose();
}

inline void append_link(RobotModel& model, const std::string& name, const Vector3d& origin_m,
                        const Vector3d& axis, const Inertial& inertial) {
  Joint joint;
  joint.name = name;
  joint.origin.translation() = origin_m;
  joint.axis = axis.normalized();
  model.joints.push_back(joint);
  Link link;
  link.name = name + "_link";
  link.inertial = inertial;
  model.links.push_back(link);
}

inline const Inertial kFirstBody{
    3.7, {0.31, 0.12, -0.07}, make_inertia({0.11, 0.23, 0.29}, {0.4, -0.7, 0.9})};
inline const Inertial kSecondBody{
    2.2, {0.24, -0.09, 0.05}, make_inertia({0.05, 0.09, 0.12}, {-0.8, 0.3, 0.5})};
inline const Inertial kThirdBody{
    1.3, {0.17, 0.06, -0.11}, make_inertia({0.021, 0.034, 0.045}, {0.2, 1.1, -0.6})};

inline RobotModel make_pendulum(const Vector3d& axis) {
  RobotModel model;
  append_link(model, "pivot", {0.2, -0.3, 1.4}, axis, kFirstBody);
  model.tip_pose.translation() = Vector3d(0.7, 0.1, 0.2);
  return model;
}

// Two parallel axes: all motion is planar, the plane's inclination is the axis's.
inline RobotModel make_planar_arm(const Vector3d& axis) {
  RobotModel model;
  append_link(model, "shoulder", {0.2, -0.3, 1.4}, axis, kFirstBody);
  append_link(model, "elbow", {0.62, 0.13, 0.21}, axis, kSecondBody);
  model.tip_pose.translation() = Vector3d(0.5, -0.1, 0.15);
  return model;
}

// Three skew axes, none of them along the world's.
inline RobotModel make_skew_arm() {
  RobotModel model;
  append_link(model, "waist", {0.1, -0.2, 0.9}, {0.3, 0.2, 1}, kFirstBody);
  append_link(model, "shoulder", {0.45, 0.14, 0.12}, {-0.2, 1, 0.3}, kSecondBody);
  append_link(model, "elbow", {0.41, -0.11, 0.16}, {0.5, 0.8, -0.4}, kThirdBody);
  model.joints[1].origin.linear() = make_rotation(Vector3d(1, 2, -1).normalized(), 0.4);
  model.joints[2].origin.linear() = make_rotation(Vector3d(-1, 0.5, 2).normalized(), -0.7);
  model.tip_pose.translation() = Vector3d(0.3, 0.08, -0.05);
  return model;
}

// The same arm on a vertical first axis.
inline RobotModel make_turntable_arm() {
  RobotModel model = make_skew_arm();
  model.joints[0].axis = Vector3d::UnitZ();
  return model;
}

inline VectorXd read_angles(const OdeArm& arm, std::size_t joints) {
  VectorXd q(static_cast<Eigen::Index>(joints));
  arm.read_angles({q.data(), joints});
  return q;
}

inline VectorXd read_rates(const OdeArm& arm, std::size_t joints) {
  VectorXd qd(static_cast<Eigen::Index>(joints));
  arm.read_rates({qd.data(), joints});
  return qd;
}

inline OdeArm make_arm(const RobotModel& model, const VectorXd& q,
                       const PhysicsSettings& physics = {}) {
  return OdeArm(model, {q.data(), static_cast<std::size_t>(q.size())}, physics);
}

inline void step(OdeArm& arm, const VectorXd& tau, double h_s) {
  arm.step({tau.data(), static_cast<std::size_t>(tau.size())}, h_s);
}

// Differences of angles, the short way round.
inline VectorXd wrap_angles(VectorXd q) {
  for (double& angle : q) {
    angle = std::remainder(angle, 2 * kPi);
  }
  return q;
}

}  // namespace armwright::physics_test
