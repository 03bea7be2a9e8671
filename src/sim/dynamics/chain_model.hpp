// The parameters of a serial chain of revolute and prismatic joints, chosen so that the equations
// of motion (chain_dynamics.hpp) need few operations. A ChainModel and the RobotModel that it is
// made from describe the same motion. Units: m, rad, kg; first moments in kg m, second moments in
// kg m^2.
//
// Frames. Frame i is fixed to link i; its z axis lies along the axis of joint i. q is the position
// of joint i (rad or m). Consecutive joints whose axes have the same direction form a group. The
// transform to the first joint of a group is
//   T(i-1, i) = Trans(offset) Rot(x, twist) Rot(z, q + angle)         if joint i is revolute,
//   T(i-1, i) = Trans(offset) Rot(x, twist) Rot(z, angle) Trans(z, q)  if it is prismatic.
// For the other joints of a group the twist is 0 and the offset lies along x.
//
// Every chain can be written in this form. Frame i-1 is turned about its own z axis until its x
// axis is perpendicular to the axes of joints i-1 and i. If the sine of the angle between these
// axes exceeds 0.1, the origins also slide along the axes until components of the offset are 0
// (Denavit and Hartenberg 1955; the modified form of Khalil and Kleinfinger 1986). Otherwise the
// origins stay where they are, because the common normal of nearly parallel axes could be
// kilometres away.
//
// Base parameters. Mass on the axis of a revolute joint does not move when the joint turns, so the
// model counts it as a part of the link before. That part of link i is equivalent to a rod on its z
// axis and has three numbers: mass, first moment z and second moment zz. A link on a prismatic
// joint never turns relative to the link before, so all its second moments are moved to that link
// (Gautier and Khalil 1990). The second moments are K = integral of r r^T dm, where r is the
// position in the link's frame; they replace the inertias. A revolute link keeps seven numbers:
// first moments x, y and second moments xx, xy, xz, yy, yz. The move changes no effort.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/dynamics/chain_layout.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::articulated {

// A chain model is the chain form of one robot. It keeps no reference to the robot and never
// changes, so threads can share it.
class ChainModel {
 public:
  // Computes the model. The robot must have at least one joint. Gravity acts along the world's -z
  // axis.
  ChainModel(const RobotModel& robot, double gravity_m_per_s2);

  int joints() const { return static_cast<int>(flags_.size()); }
  const std::vector<std::uint8_t>& flags() const { return flags_; }  // JointFlag bits per joint
  // Returns true if gravity is not 0 and not parallel to the axis of the first joint.
  bool tilted_gravity() const { return tilted_gravity_; }
  // Returns true if at least one joint is prismatic.
  bool prismatic() const { return prismatic_; }
  // Returns calc_model_packs(joints()) numbers in the order of chain_layout.hpp: for each
  // ModelField one number per joint, then one number per ModelSingle.
  const std::vector<double>& numbers() const { return numbers_; }
  // Returns the pose, in the world, of the frame in which the kernels compute. Its origin and z
  // axis are those of frame 0 with joint 0 at position 0. Its x axis is that of frame 0 before the
  // rotation Rot(z, q + angle), or Rot(z, angle) for a prismatic joint.
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
