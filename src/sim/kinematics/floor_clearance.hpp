// The clearance of an arm above a horizontal floor.
//
// A link is taken for a capsule: all points within the radius r of the straight line from its
// joint's origin to that of the next joint. r is 5 % of the arm's length. The last link tapers to
// its tip, so the tip itself may touch the floor. With z_i the height of the origin of joint i and
// z_n that of the tip, the arm clears a floor at height f if z_i - r >= f for all i, and z_n >= f.
// Origins that no motion of the arm raises or lowers (the first joint's, or a shoulder's) do not
// count: what stands there is the base.
// Limits of validity: the real thickness of links is not used, and the parts of the fixed base are
// not checked.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/kinematics/numeric_kinematics.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// The radius of a link's capsule, as a share of the arm's length.
inline constexpr double kCapsuleOfLength = 0.05;

// Returns the arm's length from its first joint to the tip (m): the sum of the distances between
// neighbouring joints, and of the ranges of prismatic joints.
double calc_arm_length_m(const RobotModel& robot);

class FloorClearance {
 public:
  // `floor_m` is a height in the world's frame (m). Keeps a reference to the kinematics.
  FloorClearance(const RobotModel& robot, const NumericKinematics& kinematics, double floor_m);

  // The place of the arm that is nearest to the floor.
  struct Lowest {
    std::size_t link = 0;    // the link that ends there (the tip belongs to the last one)
    double height_m = 0;     // of the place
    double allowed_m = 0;    // the least height that it may have
    double excess_m = -1e9;  // how far it is too low; negative: it clears the floor
  };
  // Returns it for a posture, one position per joint (rad or m).
  Lowest find_lowest(std::span<const double> q) const;

 private:
  const NumericKinematics& kinematics_;
  std::vector<double> allowed_m_;  // per joint's origin, and of the tip; -inf: it does not count
};

}  // namespace armwright
