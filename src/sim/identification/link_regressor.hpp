// The inverse dynamics of a chain as a linear function of the masses of its links:
//   M(q) a + b(q, v) = Y(q, v, a) pi.
// Each link has ten numbers in its own frame, L = (xx, xy, xz, yy, yz, zz) being its inertia about the
// frame's origin and c its centre of mass:
//   pi_l = (m, m c_x, m c_y, m c_z, L_xx, L_xy, L_xz, L_yy, L_yz, L_zz).
// Y has one row per joint and ten columns per link. Source: Atkeson, An and Hollerbach (1986),
// Estimation of inertial parameters of manipulator loads and links, The International Journal of
// Robotics Research 5, 101-119, eq. 7 to 12.
//
// Units: N m (revolute) or N (prismatic) per unit of pi; positions in rad or m.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

inline constexpr Eigen::Index kLinkNumbers = 10;
using LinkNumbers = Eigen::Matrix<double, kLinkNumbers, 1>;

LinkNumbers to_link_numbers(const Inertial& body);
// The mass must not be 0.
Inertial to_inertial(const LinkNumbers& numbers);

class LinkRegressor {
 public:
  LinkRegressor(const RobotModel& robot, double gravity_m_per_s2);

  std::size_t joint_count() const { return joints_.size(); }
  // Writes Y, of joint_count() rows and kLinkNumbers * joint_count() columns. Each argument has one
  // number per joint.
  void calc(std::span<const double> q, std::span<const double> v, std::span<const double> a,
            Eigen::Ref<Eigen::MatrixXd> y) const;

 private:
  struct Part {
    Eigen::Matrix3d turn;   // of the joint's origin, in the frame of the link before
    Eigen::Vector3d place;  // likewise
    Eigen::Vector3d axis;
    bool slides = false;
  };

  std::vector<Part> joints_;
  Eigen::Vector3d gravity_;
};

}  // namespace armwright
