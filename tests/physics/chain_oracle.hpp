// A model of a serial chain for the tests, independent of the engines: equations of motion from the
// bodies' Jacobians (Kane's method), and simple integrators. It shares only RobotModel, the
// description of the arm, with the tested code.
//
//   M(q) qdd + b(q, qd) = tau
//   M = sum over the bodies of  m Jv' Jv + Jw' I Jw
//   b = sum over the bodies of  m Jv' (a0 - g) + Jw' (I alpha0 + w x I w)
//
//   Jv, Jw      Jacobians of the velocity of the centre of mass c and of the body's spin. Their
//               columns are a x (c - p) and a for a revolute joint at p with axis a, and a and 0
//               for a prismatic joint.
//   a0, alpha0  their accelerations at qdd = 0, with 2 w x a qd of a prismatic joint (Coriolis)
//   I           inertia about the centre of mass, along the world's axes
//   g           gravity
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <vector>

#include "base/decompositions.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::physics_test {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

inline Matrix3d make_cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Rotation about a unit axis by Rodrigues' formula.
inline Matrix3d make_rotation(const Vector3d& axis, double angle_rad) {
  const Matrix3d k = make_cross_matrix(axis);
  return Matrix3d::Identity() + std::sin(angle_rad) * k + (1 - std::cos(angle_rad)) * k * k;
}

class ChainOracle {
 public:
  ChainOracle(const RobotModel& model, double gravity_m_per_s2)
      : model_(model), gravity_(gravity_m_per_s2) {}

  struct Equations {
    MatrixXd mass;  // M
    VectorXd bias;  // b
    double potential_energy_j = 0;
    Vector3d tip_m;
    std::vector<Vector3d> com_m, com_bias_m_per_s2;  // a0
    std::vector<MatrixXd> com_jacobian;              // Jv
  };

  Equations calc(const VectorXd& q, const VectorXd& qd) const {
    const Eigen::Index n = q.size();
    Equations e;
    e.mass = MatrixXd::Zero(n, n);
    e.bias = VectorXd::Zero(n);
    const Vector3d up_m_per_s2(0, 0, gravity_);
    MatrixXd spin_jacobian = MatrixXd::Zero(3, n);
    MatrixXd axes(3, n);      // of the joints
    MatrixXd joints_m(3, n);  // positions of the revolute joints
    Matrix3d rotation = Matrix3d::Identity();
    Vector3d position = Vector3d::Zero(), spin = Vector3d::Zero();
    Vector3d spin_rate = Vector3d::Zero(), acceleration = Vector3d::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Joint& joint = model_.joints[static_cast<std::size_t>(i)];
      const Vector3d step = rotation * joint.origin.translation();
      position += step;
      acceleration += spin_rate.cross(step) + spin.cross(spin.cross(step));
      rotation = rotation * joint.origin.linear();
      const Vector3d axis = rotation * joint.axis;
      axes.col(i) = axis;
      if (joint.kind == JointKind::prismatic) {
        const Vector3d slide = axis * q[i];
        position += slide;
        acceleration +=
            spin_rate.cross(slide) + spin.cross(spin.cross(slide)) + 2 * spin.cross(axis) * qd[i];
      } else {
        rotation = rotation * make_rotation(joint.axis, q[i]);
        spin_rate += spin.cross(axis) * qd[i];
        spin += axis * qd[i];
        spin_jacobian.col(i) = axis;
        joints_m.col(i) = position;
      }

      const Inertial& body = model_.links[static_cast<std::size_t>(i)].inertial;
      const Vector3d arm = rotation * body.com_m;
      const Matrix3d inertia = rotation * body.inertia_kg_m2 * rotation.transpose();
      const Vector3d com_bias = acceleration + spin_rate.cross(arm) + spin.cross(spin.cross(arm));
      MatrixXd com_jacobian = MatrixXd::Zero(3, n);
      for (Eigen::Index k = 0; k <= i; ++k) {
        const Vector3d axis_k = axes.col(k);
        if (model_.joints[static_cast<std::size_t>(k)].kind == JointKind::prismatic) {
          com_jacobian.col(k) = axis_k;
        } else {
          com_jacobian.col(k) = axis_k.cross(Vector3d(position + arm - joints_m.col(k)));
        }
      }
      e.mass += body.mass_kg * com_jacobian.transpose() * com_jacobian +
                spin_jacobian.transpose() * inertia * spin_jacobian;
      e.bias +=
          body.mass_kg * com_jacobian.transpose() * (com_bias + up_m_per_s2) +
          spin_jacobian.transpose() * (inertia * spin_rate + spin.cross(Vector3d(inertia * spin)));
      e.potential_energy_j += body.mass_kg * gravity_ * (position + arm).z();
      e.com_m.push_back(position + arm);
      e.com_bias_m_per_s2.push_back(com_bias);
      e.com_jacobian.push_back(com_jacobian);
    }
    e.tip_m = position + rotation * model_.tip_pose.translation();
    return e;
  }

  VectorXd calc_acceleration(const VectorXd& q, const VectorXd& qd, const VectorXd& tau) const {
    const Equations e = calc(q, qd);
    return e.mass.ldlt().solve(tau - e.bias);
  }

  double calc_kinetic_energy_j(const VectorXd& q, const VectorXd& qd) const {
    return 0.5 * qd.dot(calc(q, qd).mass * qd);
  }

 private:
  const RobotModel& model_;
  double gravity_;
};

struct State {
  VectorXd q, qd;
};
using Acceleration = std::function<VectorXd(double t_s, const VectorXd& q, const VectorXd& qd)>;

// Integrates with qd += h qdd(t, q, qd); q += h qd: first order, as documented for the engines.
inline State integrate_semi_implicit_euler(const Acceleration& f, State s, int steps, double h_s) {
  for (int k = 0; k < steps; ++k) {
    s.qd += h_s * f(k * h_s, s.q, s.qd);
    s.q += h_s * s.qd;
  }
  return s;
}

// The classical fourth-order Runge-Kutta method.
inline State integrate_rk4(const Acceleration& f, State s, int steps, double h_s) {
  for (int k = 0; k < steps; ++k) {
    const double t = k * h_s;
    const VectorXd v1 = s.qd, a1 = f(t, s.q, v1);
    const VectorXd v2 = s.qd + h_s / 2 * a1, a2 = f(t + h_s / 2, s.q + h_s / 2 * v1, v2);
    const VectorXd v3 = s.qd + h_s / 2 * a2, a3 = f(t + h_s / 2, s.q + h_s / 2 * v2, v3);
    const VectorXd v4 = s.qd + h_s * a3, a4 = f(t + h_s, s.q + h_s * v3, v4);
    s.q += h_s / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    s.qd += h_s / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return s;
}

}  // namespace armwright::physics_test
