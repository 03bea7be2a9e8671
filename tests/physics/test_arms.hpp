// Arms of general shape for the physics tests (no zeros, no symmetry), and functions to drive them.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "arm_types.hpp"
#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "chain_oracle.hpp"
#include "sim/robot/robot_model.hpp"

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
                        const Vector3d& axis, const Inertial& inertial,
                        JointKind kind = JointKind::revolute) {
  Joint joint;
  joint.name = name;
  joint.kind = kind;
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

// Two parallel axes: all motion is in a plane perpendicular to them.
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

// The skew arm with other joints: 'r' revolute, 'p' prismatic.
inline RobotModel make_mixed_arm(std::string_view kinds) {
  RobotModel model = make_skew_arm();
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    model.joints[i].kind = kinds[i] == 'p' ? JointKind::prismatic : JointKind::revolute;
  }
  return model;
}

// One link on a rail.
inline RobotModel make_slider(const Vector3d& axis) {
  RobotModel model;
  append_link(model, "rail", {0.2, -0.3, 1.4}, axis, kFirstBody, JointKind::prismatic);
  model.tip_pose.translation() = Vector3d(0.7, 0.1, 0.2);
  return model;
}

// Returns a random chain of `joints` links of any shape, with random kinds of joints.
inline RobotModel make_random_arm(std::size_t joints, RandomStream& random) {
  const auto draw = [&](double size) {
    const double x = random.uniform(-size, size), y = random.uniform(-size, size);
    return Vector3d(x, y, random.uniform(-size, size));
  };
  RobotModel model;
  for (std::size_t i = 0; i < joints; ++i) {
    Inertial body;
    body.mass_kg = random.uniform(0.5, 4);
    body.com_m = draw(0.4);
    const double a = random.uniform(0.02, 0.3), b = random.uniform(0.02, 0.3);
    const double share = random.uniform(0.1, 0.9);  // between |a - b| and a + b
    const double c = std::abs(a - b) + share * (a + b - std::abs(a - b));
    body.inertia_kg_m2 = make_inertia({a, b, c}, draw(2));
    const Vector3d origin_m = draw(0.6), axis = draw(1);
    const bool slides = random.uniform(0, 1) < 0.5;
    append_link(model, std::string(1, static_cast<char>('a' + i)), origin_m, axis, body,
                slides ? JointKind::prismatic : JointKind::revolute);
    const Vector3d turn = draw(2);
    model.joints.back().origin.linear() = make_rotation(turn.normalized(), turn.norm());
  }
  model.tip_pose.translation() = draw(0.5);
  return model;
}

template <class Arm>
VectorXd read_positions(const Arm& arm, std::size_t joints) {
  VectorXd q(static_cast<Eigen::Index>(joints));
  arm.read_positions({q.data(), joints});
  return q;
}

template <class Arm>
VectorXd read_rates(const Arm& arm, std::size_t joints) {
  VectorXd qd(static_cast<Eigen::Index>(joints));
  arm.read_rates({qd.data(), joints});
  return qd;
}

template <class Arm>
Arm make_arm(const RobotModel& model, const VectorXd& q, const PhysicsSettings& physics = {}) {
  return Arm(model, {q.data(), static_cast<std::size_t>(q.size())}, physics);
}

template <class Arm>
void step(Arm& arm, const VectorXd& tau, double h_s) {
  arm.step({tau.data(), static_cast<std::size_t>(tau.size())}, h_s);
}

inline bool is_prismatic(const RobotModel& model, Eigen::Index joint) {
  return model.joints[static_cast<std::size_t>(joint)].kind == JointKind::prismatic;
}

// Returns the motion from one posture to another, the short way round for revolute joints.
inline VectorXd calc_motion(const RobotModel& model, const VectorXd& from, const VectorXd& to) {
  VectorXd motion = to - from;
  for (Eigen::Index i = 0; i < motion.size(); ++i) {
    if (!is_prismatic(model, i)) {
      motion[i] = std::remainder(motion[i], 2 * kPi);
    }
  }
  return motion;
}

// Returns an upper bound of the links' turn per step.
inline double calc_turn_rad(const RobotModel& model, const VectorXd& rates, double h_s) {
  double turn_rad = 0;
  for (Eigen::Index i = 0; i < rates.size(); ++i) {
    turn_rad += is_prismatic(model, i) ? 0 : h_s * std::abs(rates[i]);
  }
  return turn_rad;
}

inline bool has_slider(const RobotModel& model) {
  return std::any_of(model.joints.begin(), model.joints.end(),
                     [](const Joint& joint) { return joint.kind == JointKind::prismatic; });
}

inline VectorXd make_vector(std::initializer_list<double> values) {
  VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

}  // namespace armwright::physics_test
