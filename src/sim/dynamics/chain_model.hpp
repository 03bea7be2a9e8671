// A serial chain of revolute and prismatic joints in the form in which its equations of motion need
// the fewest operations. It describes the same motion as the RobotModel with other parameters.
//
// Frames. Frame i is fixed to link i; its z axis lies along joint i. Consecutive joints with
// parallel axes form a group. The transform to the first joint of a group is
//   T(i-1, i) = Trans(offset) Rot(x, twist) Rot(z, q + angle).
// Within a group it is
//   T(i-1, i) = Trans(offset) Rot(z, q + angle),  with the offset along x.
// A prismatic joint turns by `angle` alone and moves by q along z. Every chain can be written in
// this form: frame i-1 is turned about its own z axis until its x axis is perpendicular to both
// joint axes. If the axes are far from parallel, the origins slide along them until components of
// the offset vanish (Denavit and Hartenberg 1955; the modified form of Khalil and Kleinfinger
// 1986). Nearly parallel axes keep their origins, because their common normal could be kilometres
// away.
//
// Base parameters. Mass on the axis of a revolute joint moves as if it belonged to the link before.
// Therefore the part of a link's mass distribution that is equivalent to a rod on its z axis (mass,
// first moment z, second moment zz) is moved to the link before. A link on a prismatic joint never
// turns relative to the link before, so its second moments are moved as well (Gautier and Khalil
// 1990, with second moments K = integral of r r' dm in place of inertias). A revolute link keeps
// seven numbers: first moments x, y and second moments xx, xy, xz, yy, yz. Energies and efforts
// stay exactly the same.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/dynamics/chain_layout.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::articulated {

// The chain form of one robot, computed once. Read-only afterwards, so threads can share it.
class ChainModel {
 public:
  // Gravity acts along the world's -z axis.
  ChainModel(const RobotModel& robot, double gravity_m_per_s2);

  int joints() const { return static_cast<int>(flags_.size()); }
  const std::vector<std::uint8_t>& flags() const { return flags_; }  // JointFlag bits per joint
  // Returns whether gravity is not parallel to the first axis.
  bool tilted_gravity() const { return tilted_gravity_; }
  // Returns whether any joint is prismatic.
  bool prismatic() const { return prismatic_; }
  // Returns calc_model_packs(joints()) numbers in the order of chain_layout.hpp.
  const std::vector<double>& numbers() const { return numbers_; }
  // Returns the pose of the kernels' frame in the world: the first joint's frame at the angle
  // -kAngle.
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
