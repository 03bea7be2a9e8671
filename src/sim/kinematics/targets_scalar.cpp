// The targets one by one, for any machine, and the functions of targets.hpp for a single target.
#include "sim/kinematics/posture_kernel.hpp"
#include "sim/kinematics/target_kernel.hpp"

namespace armwright::targets {

struct ScalarLevel;
using Number = lanes::Single<double, ScalarLevel>;

double calc_angle(double y, double x) {
  return calc_atan2(Number(y), Number(x)).v;
}

double calc_distance(const SignalCurve& curve, double t_s) {
  return calc_distance(curve, Number(t_s)).v;
}

void calc_position(const Move& move, int step, double position_m[3]) {
  const Vec3<Number> position = calc_position(move, Number(static_cast<double>(step)));
  position_m[0] = position.x.v;
  position_m[1] = position.y.v;
  position_m[2] = position.z.v;
}

double calc_wrist_distance(const ElbowUpArm& arm, const double target_m[3]) {
  return sqrt(calc_wrist(arm, Vec3<Number>{target_m[0], target_m[1], target_m[2]}).squared_distance)
      .v;
}

bool solve(const ElbowUpArm& arm, const double target_m[3], double angles_rad[4]) {
  Number angles[4];
  if (solve(arm, Vec3<Number>{target_m[0], target_m[1], target_m[2]}, angles) == 0) {
    return false;
  }
  for (int i = 0; i < 4; ++i) {
    angles_rad[i] = angles[i].v;
  }
  return true;
}

int solve_move_scalar(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad) {
  return solve_move<Number>(arm, move, steps, angles_rad);
}

void calc_positions_scalar(const Move& move, int steps, double* positions_m) {
  calc_positions<Number>(move, steps, positions_m);
}

}  // namespace armwright::targets

namespace armwright::postures {

unsigned solve_scalar(const Chain& chain, Block& block) {
  return solve_lanes<targets::Number>(chain, block);
}

}  // namespace armwright::postures
