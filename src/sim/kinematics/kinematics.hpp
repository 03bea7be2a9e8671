// Forward kinematics of a robot, and closed-form inverse kinematics of palletising arms, whose
// formula stands in target_kernel.hpp.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/kinematics/targets.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// Returns the angle wrapped to [-pi, pi].
double wrap_angle(double angle_rad);

// Returns the displacement of a joint from one position to another. For a revolute joint it is the
// shorter turn (rad, in [-pi, pi]); for a prismatic joint the difference `to` - `from` (m).
double calc_displacement(JointKind kind, double from, double to);

// Returns the pose of each link's frame in the world, for the joint positions q (rad or m, one per
// joint):
//   T_i = T_(i-1) origin_i Rot(axis_i, q_i) or T_(i-1) origin_i Trans(q_i axis_i).
std::vector<Eigen::Isometry3d> calc_link_poses(const RobotModel& model, std::span<const double> q);
// Returns the tip's position in the world (m), for the joint positions q (rad or m).
Eigen::Vector3d calc_tip_position(const RobotModel& model, std::span<const double> q);

// The offset in the thesis's erroneous inverse kinematics, which armwright reproduces on request.
// The thesis started link 1 at a point 122.5 mm beside the arm's plane (the y component of its base
// link vector, thesis Table B.1). So the wrist's horizontal distance became sqrt(f^2 + 0.1225^2).
inline constexpr double kIkBugOffset_m = 0.1225;

// Returns the question that follows a place out of reach, "; were millimetres meant? ...", if the
// place is ten times as far away as the arm reaches. Otherwise returns an empty text.
std::string ask_millimetres(double distance_m, double reach_m);

// The closed-form inverse kinematics of a palletising arm with its elbow up and its last link
// pointing straight down (thesis section 5.1). Such an arm has a vertical first axis (the world's z
// axis), then three parallel horizontal axes (along y at angle zero). Its tip lies in the vertical
// plane through the first axis; its other links may lie beside that plane.
//
// Let c be the length from joint 2 (the shoulder) to joint 3 (the elbow) and a the length from
// joint 3 to joint 4 (the wrist). Let f and e be the wrist's horizontal and vertical distance from
// the shoulder, and b = hypot(e, f). S is four times the area of the triangle shoulder-elbow-wrist
// (Heron): S^2 = ((a + c)^2 - b^2) (b^2 - (a - c)^2). Then
//   beta = acos((b^2 + c^2 - a^2) / 2bc) = atan2(S, b^2 + c^2 - a^2) at the shoulder,
//   gamma = acos((a^2 + c^2 - b^2) / 2ac) at the elbow, pi - gamma = atan2(S, b^2 - a^2 - c^2),
//   elevation of link 1 = atan2(e, f) + beta,
//   elevation of elbow-wrist = elevation of link 1 - (pi - gamma).
// A target is within reach if |a - c| <= b <= a + c and b > 0.
class ElbowUpKinematics {
 public:
  // Reads the dimensions from the model. If `ik_bug` is true, f and b are computed from a shoulder
  // that is moved sideways by kIkBugOffset_m. Throws Error{bad_data} if the robot is not such an
  // arm; the message names the reason.
  explicit ElbowUpKinematics(const RobotModel& model, bool ik_bug = false);

  // Returns nothing if the robot is not such an arm.
  static std::optional<ElbowUpKinematics> make_if_suited(const RobotModel& model, bool ik_bug);

  // Writes the four joint angles (rad) for a tip at `target_m` into q. Returns false and leaves q
  // unchanged if the target is out of reach.
  bool solve(const Eigen::Vector3d& target_m, std::span<double, 4> q) const;

  // Returns "target (x, y, z) m is out of reach: the wrist would be B m from the shoulder, possible
  // is MIN to MAX m", and ask_millimetres().
  std::string describe_unreachable(const Eigen::Vector3d& target_m) const;

  const targets::ElbowUpArm& arm() const { return arm_; }

 private:
  targets::ElbowUpArm arm_;
};

}  // namespace armwright
