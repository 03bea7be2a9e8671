// The position of the moving target and the joint angles that put an elbow-up arm's tip there.
// make_signal_curve(), ElbowUpKinematics and TrackingSetup use these plain structs and functions.
// The formulas are written once (target_kernel.hpp), for one number or for a SIMD register of
// numbers.
//
// Every engine uses these angles. Therefore they have the same bits at every SIMD level and on
// every machine: the code uses only correctly rounded operations, in a fixed order, without fused
// multiply-add.
//
// This header does not use templates of the standard library, because it is compiled for every
// instruction set (lane_pack.hpp).
#pragma once

#include <cstdint>

namespace armwright {

enum class SimdLevel : std::uint8_t;
enum class SignalShape { step, ramp, trapezoid, triangular, complex };

namespace targets {

// A reference signal (sim/tracking/reference_signal.hpp).
struct SignalCurve {
  SignalShape shape = SignalShape::complex;
  double distance_m = 0;
  double speed_m_per_s = 0;
  double duration_s = 0;             // t_m
  double ramp_up_s = 0;              // trapezoid: duration of the acceleration
  double acceleration_m_per_s2 = 0;  // trapezoid and triangular only
};

// The parameters of an ElbowUpKinematics, which explains them.
struct ElbowUpArm {
  double sign[4] = {};            // -1 if an axis points along -z (joint 1) or -y, else +1
  double shoulder_radius_m = 0;   // g: distance of joint 2 from the first axis
  double shoulder_height_m = 0;   // h
  double upper_arm_m = 0;         // c
  double forearm_m = 0;           // a
  double last_link_m = 0;         // d
  double upper_arm_zero_rad = 0;  // elevation of each part at angle 0
  double forearm_zero_rad = 0;
  double last_link_zero_rad = 0;
  double shoulder_offset_m = 0;  // o: kIkBugOffset_m with the thesis's error, else 0
};

// A move of the target from one point to the next. At the end of step k (from 0) the move's time is
// (k + 1) h. From the time t_m on, the target is exactly at the second point.
struct Move {
  double from_m[3] = {};
  double to_m[3] = {};
  double way_m[3] = {};  // to - from
  SignalCurve curve;
  double period_s = 0;  // h
};

// Returns atan2(y, x) in rad; lane_trigonometry.hpp states the error.
double calc_angle(double y, double x);
// Returns how far the target has moved along its way after t_s (m).
double calc_distance(const SignalCurve& curve, double t_s);
// Writes the target's position at the end of the step (m).
void calc_position(const Move& move, int step, double position_m[3]);
// Returns the distance of the wrist from the shoulder (m) with the tip at the target.
double calc_wrist_distance(const ElbowUpArm& arm, const double target_m[3]);
// Writes the four angles (rad) for a tip at the target. Returns false and leaves them unchanged if
// the target is out of reach.
bool solve(const ElbowUpArm& arm, const double target_m[3], double angles_rad[4]);

// Writes the angles (rad) for steps 0 to `steps` - 1 of the move, four per step. Returns the number
// of steps before the first one whose target is out of reach; the angles of later steps are
// invalid.
using SolveMove = int(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad);
// Writes the target's positions at the ends of steps 0 to `steps` - 1 (m), three per step: the same
// numbers as calc_position().
using CalcPositions = void(const Move& move, int steps, double* positions_m);

struct MoveFunctions {
  SolveMove* solve_move;
  CalcPositions* calc_positions;
};
// Returns the functions for the level, which this CPU must support.
MoveFunctions get_move_functions(SimdLevel level);

// Each function is defined in a file that is compiled for its instruction set.
SolveMove solve_move_scalar, solve_move_sse2, solve_move_avx2, solve_move_avx512;
CalcPositions calc_positions_scalar, calc_positions_sse2, calc_positions_avx2,
    calc_positions_avx512;

}  // namespace targets
}  // namespace armwright
