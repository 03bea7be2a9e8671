// Whether an arm's joints can do what a target's path asks of them, looked at before anything is
// simulated: along the whole table of target angles, how far joints leave their ranges, how fast
// they would have to move, and how close to a singularity the arm comes.
//
//   position  q_i outside [lower_i, upper_i] (of angles the turn that is nearest to the range)
//   speed     |q_i(k + 1) - q_i(k)| / h above the joint's speed limit
//   singular  the smallest singular value of the tool's Jacobian that counts, below 1 % of the
//             largest (numeric_kinematics.hpp): there small moves of the tool take large ones of
//             joints. The joint named is the one that moves most where the tool hardly does.
#pragma once

#include <string>
#include <vector>

#include "sim/tracking/tracking.hpp"

namespace armwright {

inline constexpr double kSingularDexterity = 0.01;

struct PathFault {
  enum class Kind { position, speed, singular };
  Kind kind = Kind::position;
  std::size_t joint = 0;
  std::size_t point = 0;  // the path to it has the worst of this kind and joint, from 1 on
  double time_s = 0;
  double value = 0;  // rad, rad/s, m, m/s, or the ratio of singular values
  double limit = 0;
};

// The worst of every kind and joint, by joints and positions first; empty: nothing is wrong. The
// table must be whole.
std::vector<PathFault> find_path_faults(const TrackingSetup& setup, const TargetTable& table);

// "on the way to point 3: joint 2 ('shoulder') would have to move at 4.1 rad/s (at 2.31 s), its
// limit is 3.05 rad/s".
std::string describe(const PathFault& fault, const RobotModel& robot);

// Why numeric kinematics do not reach a pose, as far as it can be told from where they began.
std::string describe_unreachable(const NumericKinematics& kinematics, const RobotModel& robot,
                                 const ToolTask& tool, const ToolPose& target,
                                 std::span<const double> from);

}  // namespace armwright
