// The memory layout of a chain's model. Its numbers lie in packs: a pack has one number per SIMD
// lane, side by side. Every ModelField has one pack per joint, every ModelSingle one pack per
// chain.
//
// This header is compiled for every instruction set (lane_pack.hpp), so it must not use templates
// of the standard library.
#pragma once

#include <cstdint>

namespace armwright::articulated {

inline constexpr int kMostToolPoints = 4;

// The constants of one joint and of the link that it moves; chain_model.hpp explains them.
enum ModelField : int {
  kAngle,
  kTwistCos,
  kTwistSin,
  kOffsetX,
  kOffsetY,
  kOffsetZ,
  kMomentX,  // first moments of mass of the link
  kMomentY,
  kSecondXX,  // second moments
  kSecondXY,
  kSecondXZ,
  kSecondYY,
  kSecondYZ,
  kMass,     // of links on prismatic joints; else 0
  kMomentZ,  // likewise
  kModelFields
};
// The constants of the chain, which follow the joints' constants.
enum ModelSingle : int {
  kGravityX,
  kGravityZ,
  kTipX,
  kTipY,
  kTipZ,
  kToolX,  // x, y and z of each tool point (RobotModel::tool_points_m), in the last link's frame
  kModelSingles = kToolX + 3 * kMostToolPoints
};

constexpr int calc_model_packs(int joints) {
  return joints * kModelFields + kModelSingles;
}
// The scratch memory of ChainDynamics for a chain whose length is not known when it is compiled.
constexpr int calc_dynamics_packs(int joints) {
  return 24 * joints + joints * joints;
}

// Facts about a joint that are the same in all lanes. They decide which arithmetic can be left out.
enum JointFlag : std::uint8_t {
  kPrismatic = 1,
  kSameAxis = 2,    // parallel to the joint before: belongs to the same group
  kRightAngle = 4,  // twisted by 90 degrees against the group before
  kAlongX = 8,      // the offset has only an x component
};

}  // namespace armwright::articulated
