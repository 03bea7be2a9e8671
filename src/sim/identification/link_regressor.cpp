#include "sim/identification/link_regressor.hpp"

namespace armwright {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d make_cross_matrix(const Vector3d& v) {
  Matrix3d cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return cross;
}

// Returns the matrix of w with (w . (L_xx, L_xy, L_xz, L_yy, L_yz, L_zz)) = L w.
Eigen::Matrix<double, 3, 6> make_inertia_matrix(const Vector3d& w) {
  Eigen::Matrix<double, 3, 6> matrix;
  matrix << w.x(), w.y(), w.z(), 0, 0, 0,  //
      0, w.x(), 0, w.y(), w.z(), 0,        //
      0, 0, w.x(), 0, w.y(), w.z();
  return matrix;
}

}  // namespace

LinkNumbers to_link_numbers(const Inertial& body) {
  const Vector3d& c = body.com_m;
  const Matrix3d about_origin =
      body.inertia_kg_m2 +
      body.mass_kg * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
  LinkNumbers numbers;
  numbers << body.mass_kg, body.mass_kg * c, about_origin(0, 0), about_origin(0, 1),
      about_origin(0, 2), about_origin(1, 1), about_origin(1, 2), about_origin(2, 2);
  return numbers;
}

Inertial to_inertial(const LinkNumbers& n) {
  Inertial body;
  body.mass_kg = n[0];
  const Vector3d c = n.segment<3>(1) / n[0];
  body.com_m = c;
  Matrix3d about_origin;
  about_origin << n[4], n[5], n[6], n[5], n[7], n[8], n[6], n[8], n[9];
  body.inertia_kg_m2 =
      about_origin - n[0] * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
  return body;
}

LinkRegressor::LinkRegressor(const RobotModel& robot, double gravity_m_per_s2)
    : gravity_(0, 0, -gravity_m_per_s2) {
  for (const Joint& joint : robot.joints) {
    joints_.push_back({joint.origin.linear(), joint.origin.translation(), joint.axis,
                       joint.kind == JointKind::prismatic});
  }
}

void LinkRegressor::calc(std::span<const double> q, std::span<const double> v,
                         std::span<const double> a, Eigen::Ref<Eigen::MatrixXd> y) const {
  y.setZero();
  // Each link has, in its own frame, a pose relative to the link before, an angular velocity and
  // acceleration, and the acceleration of its origin minus gravity.
  std::vector<Matrix3d> turns(joints_.size());
  std::vector<Vector3d> places(joints_.size());
  Vector3d w = Vector3d::Zero(), dw = Vector3d::Zero(), acceleration = -gravity_;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Part& part = joints_[i];
    turns[i] =
        part.slides ? part.turn : part.turn * Eigen::AngleAxisd(q[i], part.axis).toRotationMatrix();
    places[i] = part.slides ? Vector3d(part.place + q[i] * (part.turn * part.axis)) : part.place;
    acceleration =
        turns[i].transpose() * (acceleration + dw.cross(places[i]) + w.cross(w.cross(places[i])));
    w = turns[i].transpose() * w;
    dw = turns[i].transpose() * dw;
    if (part.slides) {
      acceleration += a[i] * part.axis + 2 * v[i] * w.cross(part.axis);
    } else {
      dw += a[i] * part.axis + v[i] * w.cross(part.axis);
      w += v[i] * part.axis;
    }
    // The force and the moment about the link's origin that its ten numbers need.
    const Matrix3d spin = make_cross_matrix(w);
    Eigen::Matrix<double, 3, kLinkNumbers> force = Eigen::Matrix<double, 3, kLinkNumbers>::Zero();
    Eigen::Matrix<double, 3, kLinkNumbers> moment = force;
    force.col(0) = acceleration;
    force.middleCols<3>(1) = make_cross_matrix(dw) + spin * spin;
    moment.middleCols<3>(1) = -make_cross_matrix(acceleration);
    moment.rightCols<6>() = make_inertia_matrix(dw) + spin * make_inertia_matrix(w);
    const auto column = static_cast<Eigen::Index>(i) * kLinkNumbers;
    for (std::size_t k = i + 1; k-- > 0;) {
      const Part& at = joints_[k];
      y.block<1, kLinkNumbers>(static_cast<Eigen::Index>(k), column) =
          at.axis.transpose() * (at.slides ? force : moment);
      // Moves both to the frame of the link before.
      force = turns[k] * force;
      moment = turns[k] * moment + make_cross_matrix(places[k]) * force;
    }
  }
}

}  // namespace armwright
