// Checks, before any simulation, whether an arm's joints can follow a target's path. The whole
// table of target positions is searched for these faults:
//
//   position  q_i outside [lower_i, upper_i]; of an angle, the turn nearest to the range counts
//   speed     |q_i(k + 1) - q_i(k)| / h above the joint's speed limit
//   singular  the smallest singular value of the tool's Jacobian that counts is below 1 % of the
//             largest (numeric_kinematics.hpp). Near a singularity, small moves of the tool take
//             large moves of joints. The fault names the joint that moves most while the tool
//             hardly moves.
//   floor     if the task has a floor: the end of a link is too low (floor_clearance.hpp). The fault
//             names the joint that moves the link.
//   obstacle  if the task has obstacles, or links that must keep clear of each other: two of them
//             are nearer than the task's clearance_m (arm_clearance.hpp). The fault names the joint
//             that moves the link. The first posture counts too, at 0 s.
#pragma once

#include <string>
#include <vector>

#include "sim/tracking/tracking_setup.hpp"

namespace armwright {

inline constexpr double kSingularDexterity = 0.01;

struct PathFault {
  enum class Kind { position, speed, singular, floor, obstacle };
  Kind kind = Kind::position;
  std::size_t joint = 0;
  std::size_t point = 0;  // the worst fault lies on the way to this point, counted from 1
  double time_s = 0;
  double value = 0;  // rad, rad/s, m, m/s, the ratio of singular values, a height or distance in m
  double limit = 0;
  std::string other = {};  // what the link comes too close to: "the obstacle 'post'"
};

// Returns the worst fault of every kind and joint: by joints, positions before speeds, then the
// singularity, the floor and the obstacle. Empty: the path has no fault. The table must be complete.
std::vector<PathFault> find_path_faults(const TrackingSetup& setup, const TargetTable& table);

// Returns a text such as "on the way to point 3: joint 2 ('shoulder') would have to move at
// 4.1 rad/s (at 2.31 s), its limit is 3.05 rad/s".
std::string describe(const PathFault& fault, const RobotModel& robot);

// Returns the likely reason why numeric kinematics that began at `from` did not reach a pose.
std::string describe_unreachable(const NumericKinematics& kinematics, const RobotModel& robot,
                                 const ToolTask& tool, const ToolPose& target,
                                 std::span<const double> from);

}  // namespace armwright
