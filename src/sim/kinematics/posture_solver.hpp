// Damped least squares (numeric_kinematics.hpp has the equations) for eight postures at once, one
// per SIMD lane. NumericKinematics uses these plain structs and functions. The formulas are written
// once (posture_kernel.hpp), for any lane type.
//
// Each iteration solves an equal system that is as small as the task: with the rows of J, not its
// columns,
//   dq = w + J^T (J J^T + mu^2 1)^-1 (e - J w).
// A joint that is held at the end of its range has its column of J set to 0, and its motion is
// subtracted from e.
//
// The frames of the chain are chosen so that the axis of each joint is z, and the next axis results
// from a turn about z and one about x (Denavit and Hartenberg 1955, A kinematic notation for
// lower-pair mechanisms based on matrices, Journal of Applied Mechanics 22, 215-221).
//
// A posture has the same bits at every SIMD level, on every machine and beside any other postures:
// the code uses only correctly rounded operations, in a fixed order, without fused multiply-add.
//
// This header does not use templates of the standard library, because it is compiled for every
// instruction set (lane_pack.hpp).
#pragma once

#include <cstdint>

namespace armwright {

enum class SimdLevel : std::uint8_t;
enum class ToolOrientation { free, pointing, pose };  // tool_task.hpp explains them

namespace postures {

inline constexpr int kMostJoints = 16;
inline constexpr int kLanes = 8;

// A joint, in the frame of the joint before it, which is turned about z by `turn_rad` of that joint.
struct ChainJoint {
  double place_m[3] = {};
  double tilt_cos = 1, tilt_sin = 0;  // of the angle about x between the two axes
  // The angle about z, beside the joint's own, to the frame of the next joint.
  double turn_rad = 0;
  bool slides = false;
  double unit_m = 1;            // a sliding joint's way is counted in this unit
  double lower = 0, upper = 0;  // the joint's range (rad or units); may be infinite
};

// A serial chain and its task.
struct Chain {
  int joints = 0;
  bool within_limits = false;
  ToolOrientation orientation = ToolOrientation::free;
  double base_turn_cos = 1, base_turn_sin = 0;  // of turn_rad of the base
  ChainJoint joint[kMostJoints];
  double tip_place_m[3] = {};  // in the frame of the last joint
  double tip_turn[3][3] = {};
  double tool_axis[3] = {};       // pointing: in the frame of the tip
  double last_tool_axis[3] = {};  // likewise, in the frame of the last joint
  double arm_m = 0;               // L
  // No joint is farther from the tip; may be infinite. Then a posture is never certain without
  // another look.
  double reach_m = 0;
  double tolerance_m = 0;    // the largest |e| of a solution
  double least_damping = 0;  // the least mu^2, as a fraction of the largest (J^T J)_ii
};

// Eight searches for a posture, each [number][lane].
struct Block {
  alignas(64) double q[kMostJoints][kLanes];  // start, then solution (rad or units)
  double wish[kMostJoints][kLanes];           // w, of the first iteration
  double position_m[3][kLanes];               // the target
  double turn[3][3][kLanes];                  // not used if the orientation is free
  double iterations[kLanes];                  // the most iterations; 0: the lane is not used
  double longest_step[kLanes];
};

// Iterates every lane until it is at its target. Returns one bit per lane, set if it got there; q is
// invalid in other lanes.
using Solve = unsigned (*)(const Chain& chain, Block& block);
// Returns the function for the level, which this CPU must support.
Solve get_solve(SimdLevel level);

// Each function is defined in the file targets_LEVEL.cpp, which is compiled for its instruction set.
unsigned solve_scalar(const Chain& chain, Block& block);
unsigned solve_sse2(const Chain& chain, Block& block);
unsigned solve_avx2(const Chain& chain, Block& block);
unsigned solve_avx512(const Chain& chain, Block& block);

}  // namespace postures
}  // namespace armwright
