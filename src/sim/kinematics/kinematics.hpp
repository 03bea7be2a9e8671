// Where the links are for given joint positions, and back again.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/kinematics/targets.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// Angle wrapped to [-pi, pi].
double wrap_angle(double angle_rad);

// How far a joint has to move from one position to another: the short way round if it is revolute
// (rad, in [-pi, pi]), there and nowhere else if it is prismatic (m).
double calc_displacement(JointKind kind, double from, double to);

// Pose of every link frame in the world for the joint positions q (rad or m), one a joint:
//   T_i = T_(i-1) origin_i Rot(axis_i, q_i) or T_(i-1) origin_i Trans(q_i axis_i).
std::vector<Eigen::Isometry3d> calc_link_poses(const RobotModel& model, std::span<const double> q);
Eigen::Vector3d calc_tip_position(const RobotModel& model, std::span<const double> q);

// The thesis's error in the inverse kinematics, reproduced on request: it started link 1 at a point
// 122.5 mm to the side of the common plane (the y component of its base link vector, thesis Table
// B.1), so that the wrist's horizontal distance became sqrt(f^2 + 0.1225^2).
inline constexpr double kIkBugOffset_m = 0.1225;

// Closed-form inverse kinematics of a palletising arm: a vertical first axis (the world's z axis),
// then three parallel horizontal ones (at angle zero along y), the tip in the vertical plane
// through the first axis; links may lie beside that plane as long as the tip does not. Elbow up,
// the last link pointing straight down (thesis section 5.1). With a and c the lengths of joint 3-4
// and joint 2-3, p1 the shoulder, p3 the wrist, f and e its horizontal and vertical distance from
// the shoulder, b = hypot(e, f), and S four times the area of the triangle shoulder-elbow-wrist
// (Heron), S^2 = ((a + c)^2 - b^2) (b^2 - (a - c)^2):
//   beta = acos((b^2 + c^2 - a^2) / 2bc) = atan2(S, b^2 + c^2 - a^2) at the shoulder,
//   gamma = acos((a^2 + c^2 - b^2) / 2ac) at the elbow, pi - gamma = atan2(S, b^2 - a^2 - c^2),
//   elevation of link 1 = atan2(e, f) + beta,
//   elevation of elbow-wrist = elevation of link 1 - (pi - gamma).
// Within reach is |a - c| <= b <= a + c, b > 0.
class ElbowUpKinematics {
 public:
  // Reads its dimensions from the model. Error{bad_data} names what the robot lacks where it is not
  // of this kind. `ik_bug` computes f and b from a shoulder moved sideways by kIkBugOffset_m.
  explicit ElbowUpKinematics(const RobotModel& model, bool ik_bug = false);

  // Nothing where the robot is not of this kind.
  static std::optional<ElbowUpKinematics> make_if_suited(const RobotModel& model, bool ik_bug);

  // The four joint angles for a tip at `target_m`; false (and q untouched) if it is out of reach.
  bool solve(const Eigen::Vector3d& target_m, std::span<double, 4> q) const;

  // "target (x, y, z) m is out of reach: the wrist would be B m from the shoulder, possible is MIN
  // to MAX m".
  std::string describe_unreachable(const Eigen::Vector3d& target_m) const;

  const targets::ElbowUpArm& arm() const { return arm_; }

 private:
  targets::ElbowUpArm arm_;
};

}  // namespace armwright
