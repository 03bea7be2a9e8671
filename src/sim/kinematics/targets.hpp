// Where the moving target is and which joint angles put an elbow-up arm's tip there: plain numbers
// and functions on them, behind ReferenceSignal, ElbowUpKinematics and TrackingSetup. Their
// formulas are written once (target_kernel.hpp), for one number or a SIMD register of them.
//
// The angles feed every engine, so they are the same bits at every SIMD level and on every machine:
// correctly rounded operations only, in the same order, none fused.
//
// Nothing of the standard library here: this is compiled for every instruction set (lane_pack.hpp).
#pragma once

#include <cstdint>

namespace armwright {

enum class SimdLevel : std::uint8_t;
enum class SignalShape { step, ramp, trapezoid, triangular, complex };

namespace targets {

// The numbers of a ReferenceSignal; see there.
struct SignalCurve {
  SignalShape shape = SignalShape::complex;
  double distance_m = 0;
  double speed_m_per_s = 0;
  double duration_s = 0;             // t_m
  double ramp_up_s = 0;              // trapezoid: how long it accelerates
  double acceleration_m_per_s2 = 0;  // trapezoid and triangular: the one used
};

// The numbers of an ElbowUpKinematics; see there.
struct ElbowUpArm {
  double sign[4] = {};            // -1 where a joint's axis is the opposite of +z (the first) or +y
  double shoulder_radius_m = 0;   // g: of joint 2 from the first axis
  double shoulder_height_m = 0;   // h
  double upper_arm_m = 0;         // c
  double forearm_m = 0;           // a
  double last_link_m = 0;         // d
  double upper_arm_zero_rad = 0;  // elevation of each part at angle 0
  double forearm_zero_rad = 0;
  double last_link_zero_rad = 0;
  double shoulder_offset_m = 0;  // o: the thesis's error puts it that far beside the arm's plane
};

// The target's move from one point to the next. At the end of step k its clock shows (k + 1) h;
// from t_m on it is at the second point, exactly.
struct Move {
  double from_m[3] = {};
  double to_m[3] = {};
  double way_m[3] = {};  // to - from
  SignalCurve curve;
  double period_s = 0;  // h
};

double calc_angle(double y, double x);  // atan2; lane_trigonometry.hpp says how exact
double calc_distance(const SignalCurve& curve, double t_s);
void calc_position(const Move& move, int step, double position_m[3]);
// How far the wrist is from the shoulder with the tip at the target.
double calc_wrist_distance(const ElbowUpArm& arm, const double target_m[3]);
// False, and the angles untouched, if the target is out of reach.
bool solve(const ElbowUpArm& arm, const double target_m[3], double angles_rad[4]);

// The angles for steps 0 to `steps` - 1 of the move, four a step. Returns how many steps can be
// reached before the first that cannot, the angles behind them being of no use.
using SolveMove = int (*)(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad);
SolveMove get_solve_move(SimdLevel level);  // the level must be supported by this CPU

// Each defined in a file that is compiled for its instruction set.
int solve_move_scalar(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad);
int solve_move_sse2(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad);
int solve_move_avx2(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad);
int solve_move_avx512(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad);

}  // namespace targets
}  // namespace armwright
