// The formulas of targets.hpp, with the closed form of the inverse kinematics, for any lane type V
// of double. Only files that are compiled for one
// instruction set, without fused multiply-add, include this header. Each uses its own `Isa` in V
// (lane_pack.hpp).
#pragma once

#include "sim/kinematics/targets.hpp"
#include "sim/simd/lane_trigonometry.hpp"

namespace armwright::targets {

using lanes::calc_angle_above;
using lanes::calc_atan2;
using lanes::select;
using lanes::sqrt;
using lanes::Vec3;

template <class V>
ARMWRIGHT_INLINE V calc_distance(const SignalCurve& curve, V t) {
  const V whole = curve.distance_m;
  const V acceleration = curve.acceleration_m_per_s2;
  const V ramp_up = curve.ramp_up_s;
  const V left = V(curve.duration_s) - t;
  V s = whole;
  switch (curve.shape) {
    case SignalShape::step:
      return s;
    case SignalShape::ramp:
      s = V(curve.speed_m_per_s) * t;  // before t_m rounding cannot exceed ds
      break;
    case SignalShape::trapezoid: {
      const V plateau = acceleration * ramp_up * (t - V(0.5) * ramp_up);
      const V down = whole - V(0.5) * acceleration * left * left;
      s = select(t > ramp_up, select(left > ramp_up, plateau, down), V(0.5) * acceleration * t * t);
      break;
    }
    case SignalShape::triangular:
      s = select(t > left, whole - V(0.5) * acceleration * left * left,
                 V(0.5) * acceleration * t * t);
      break;
    case SignalShape::complex: {
      // x = v t / ds = t / t_m. The speed peaks at x = 0.4, where both pieces give ds / 2.
      const V x = t / V(curve.duration_s);
      const V rest = V(1.0) - x;
      s = select(x > V(0.4), whole * (V(1.0) - V(125.0 / 54.0) * rest * rest * rest),
                 whole * V(25.0 / 8.0) * x * x);
      break;
    }
  }
  return select(t < V(curve.duration_s), s, whole);
}

// Returns the target's position in each lane. `step` has one whole number per lane.
template <class V>
ARMWRIGHT_INLINE Vec3<V> calc_position(const Move& move, V step) {
  const V time = (step + V(1.0)) * V(move.period_s);
  const V share = calc_distance(move.curve, time) / V(move.curve.distance_m);
  // From t_m on this is exactly the end point, not the start plus a rounded move.
  const auto moving = time < V(move.curve.duration_s);
  const auto place = [&](int i) __attribute__((always_inline)) {
    return select(moving, V(move.from_m[i]) + V(move.way_m[i]) * share, V(move.to_m[i]));
  };
  return {place(0), place(1), place(2)};
}

// The wrist's position relative to the shoulder in the arm's vertical plane; the wrist is above the
// target.
template <class V>
struct Wrist {
  V forward, up, squared_distance;  // f, e, b^2
};
template <class V>
ARMWRIGHT_INLINE Wrist<V> calc_wrist(const ElbowUpArm& arm, Vec3<V> target) {
  Wrist<V> wrist;
  wrist.forward = sqrt(target.x * target.x + target.y * target.y) - V(arm.shoulder_radius_m);
  if (arm.shoulder_offset_m > 0) {
    const double offset = arm.shoulder_offset_m;
    wrist.forward = sqrt(wrist.forward * wrist.forward + V(offset * offset));
  }
  wrist.up = target.z + V(arm.last_link_m) - V(arm.shoulder_height_m);
  wrist.squared_distance = wrist.up * wrist.up + wrist.forward * wrist.forward;
  return wrist;
}

// Writes the four angles of each lane. Returns one bit per lane, set if the target is within reach;
// the angles of other lanes are invalid.
template <class V>
ARMWRIGHT_INLINE unsigned solve(const ElbowUpArm& arm, Vec3<V> target, V* angles) {
  const double a = arm.forearm_m;
  const double c = arm.upper_arm_m;
  const V farthest = (a + c) * (a + c);
  const V nearest = (a - c) * (a - c);
  const Wrist<V> wrist = calc_wrist(arm, target);
  const V b2 = wrist.squared_distance;
  // The first comparison excludes NaN and a wrist that coincides with the shoulder.
  const unsigned reached =
      find_less(V(0.0), b2) & ~find_less(farthest, b2) & ~find_less(b2, nearest);

  // The upper arm's elevation is the wrist's elevation plus beta: the direction (f, e) is turned by
  // an angle with the tangent area / along. If the wrist's elevation is positive, so is the sum,
  // also beyond pi.
  const V area = sqrt((farthest - b2) * (b2 - nearest));
  const V along = b2 + V(c * c - a * a);
  const V direction =
      calc_atan2(wrist.up * along + wrist.forward * area, wrist.forward * along - wrist.up * area);
  const V turn = select(wrist.up < V(0.0), V(0.0), V(6.28318530717958647693));
  const V upper_arm_elevation = direction + select(direction < V(0.0), turn, V(0.0));
  const V bend = calc_angle_above(area, b2 - V(c * c + a * a));
  const V heading = calc_atan2(target.y, target.x);
  const V forearm_elevation = upper_arm_elevation - bend;
  constexpr double kLastLinkElevation = -1.57079632679489661923;

  // A positive rotation about +y tips a link down. So the angles of joints 2 to i add up to the
  // link's elevation at angle zero minus its wanted elevation.
  const V q2 = V(arm.upper_arm_zero_rad) - upper_arm_elevation;
  const V q23 = V(arm.forearm_zero_rad) - forearm_elevation;
  const V q234 = arm.last_link_zero_rad - kLastLinkElevation;
  angles[0] = V(arm.sign[0]) * heading;
  angles[1] = V(arm.sign[1]) * q2;
  angles[2] = V(arm.sign[2]) * (q23 - q2);
  angles[3] = V(arm.sign[3]) * (q234 - q23);
  return reached;
}

// Writes kWidth packs as rows of kWidth numbers, one row per lane, for the first `count` lanes.
template <int kWidth, class V>
ARMWRIGHT_INLINE void write_rows(const V* packs, int count, double* rows) {
  double numbers[kWidth][V::kLanes];
  __builtin_memcpy(numbers, packs, sizeof numbers);
  for (int lane = 0; lane < count; ++lane) {
    for (int column = 0; column < kWidth; ++column) {
      rows[kWidth * lane + column] = numbers[column][lane];
    }
  }
}

// Returns `first`, `first` + 1, ..., one number per lane.
template <class V>
ARMWRIGHT_INLINE V count_from(int first) {
  constexpr double kNumbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  static_assert(V::kLanes <= 8);
  V lane;
  __builtin_memcpy(static_cast<void*>(&lane), kNumbers, sizeof lane);
  return V(static_cast<double>(first)) + lane;
}

// Implements SolveMove (targets.hpp) for one lane type.
template <class V>
ARMWRIGHT_INLINE int solve_move(const ElbowUpArm& arm, const Move& move, int steps, double* rows) {
  constexpr int kLanes = V::kLanes;
  for (int first = 0; first < steps; first += kLanes) {
    V angles[4];
    const unsigned reached = solve(arm, calc_position(move, count_from<V>(first)), angles);
    const int left = steps - first;
    if (left >= kLanes) {
      write_rows<4>(angles, kLanes, rows + 4 * first);
    } else {
      write_rows<4>(angles, left, rows + 4 * first);
    }
    const unsigned wanted = (left < kLanes ? 1U << left : 1U << kLanes) - 1;
    if ((reached & wanted) != wanted) {
      return first + __builtin_ctz(~reached);
    }
  }
  return steps;
}

// Implements CalcPositions (targets.hpp) for one lane type.
template <class V>
ARMWRIGHT_INLINE void calc_positions(const Move& move, int steps, double* rows) {
  for (int first = 0; first < steps; first += V::kLanes) {
    const Vec3<V> position = calc_position(move, count_from<V>(first));
    const V packs[3] = {position.x, position.y, position.z};
    const int left = steps - first;
    write_rows<3>(packs, left < V::kLanes ? left : V::kLanes, rows + 3 * first);
  }
}

}  // namespace armwright::targets
