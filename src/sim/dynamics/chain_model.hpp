// A serial chain of revolute and prismatic joints, in the form in which its equations of motion
// cost least. The same motion as the RobotModel's, other parameters:
//
// Frames. Frame i is fixed to link i, its z axis along joint i. Consecutive joints with parallel
// axes form a group. Into a new group leads
//   T(i-1, i) = Trans(offset) Rot(x, twist) Rot(z, q + angle),
// within a group Trans(offset) Rot(z, q + angle) with an offset along x; a prismatic joint turns by
// `angle` alone and moves by q along z. Every chain has this form: frame i-1 is turned about its
// own z until its x axis is perpendicular to both axes. Where axes are well apart from parallel,
// origins slide along them until offsets lose components (Denavit and Hartenberg 1955; the
// modified form of Khalil and Kleinfinger 1986). Nearly parallel axes keep theirs: no common normal
// is computed that might lie kilometres away.
//
// Base parameters. Mass on the axis of a revolute joint moves as if it belonged to the link
// before, so what of a link is equivalent to a rod on its z axis (mass, first moment z, second
// moment zz) is moved there; the second moments of a link on a prismatic joint likewise, since it
// never turns against the link before (Gautier and Khalil 1990, with second moments K = integral of
// r r' dm in place of inertias). A revolute link keeps seven numbers: first moments x, y and
// second moments xx, xy, xz, yy, yz. Energies and efforts are exactly the same.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/dynamics/chain_layout.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::articulated {

class ChainModel {
 public:
  // gravity_m_per_s2 pulls along the world's -z.
  ChainModel(const RobotModel& robot, double gravity_m_per_s2);

  int joints() const { return static_cast<int>(flags_.size()); }
  const std::vector<std::uint8_t>& flags() const { return flags_; }  // JointFlag bits
  bool tilted_gravity() const { return tilted_gravity_; }
  bool prismatic() const { return prismatic_; }
  // calc_model_packs(joints()) numbers in the order of chain_layout.hpp.
  const std::vector<double>& numbers() const { return numbers_; }
  // The kernels' frame: where the first joint would be at angle -kAngle.
  const Eigen::Isometry3d& base_pose() const { return base_pose_; }

 private:
  struct Link;
  void place_frames(const RobotModel& robot, std::vector<Link>& links, double gravity_m_per_s2);
  void connect(std::vector<Link>& links);
  static void reduce(std::vector<Link>& links);

  std::vector<std::uint8_t> flags_;
  std::vector<double> numbers_;
  bool tilted_gravity_ = false;
  bool prismatic_ = false;
  Eigen::Isometry3d base_pose_ = Eigen::Isometry3d::Identity();
};

}  // namespace armwright::articulated
