// The iterations of posture_solver.hpp, for any lane type V of double. Only files that are compiled
// for one instruction set, without fused multiply-add, include this header. Each uses its own `Isa`
// in V (lane_pack.hpp).
#pragma once

#include "sim/kinematics/posture_solver.hpp"
#include "sim/simd/lane_math.hpp"
#include "sim/simd/lane_trigonometry.hpp"

namespace armwright::postures {

using lanes::abs;
using lanes::calc_angle_above;
using lanes::calc_sine_cosine;
using lanes::max;
using lanes::min;
using lanes::select;
using lanes::sqrt;
using lanes::Vec3;

template <class V>
ARMWRIGHT_INLINE Vec3<V> operator+(Vec3<V> a, Vec3<V> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
ARMWRIGHT_INLINE Vec3<V> operator-(Vec3<V> a, Vec3<V> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
ARMWRIGHT_INLINE Vec3<V> operator*(V a, Vec3<V> b) {
  return {a * b.x, a * b.y, a * b.z};
}
template <class V>
ARMWRIGHT_INLINE V dot(Vec3<V> a, Vec3<V> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
ARMWRIGHT_INLINE Vec3<V> cross(Vec3<V> a, Vec3<V> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class V>
ARMWRIGHT_INLINE V load(const double* numbers) {
  V pack;
  __builtin_memcpy(static_cast<void*>(&pack), numbers, sizeof pack);
  return pack;
}

// A rotation, by its columns.
template <class V>
struct Turn {
  Vec3<V> x, y, z;

  // Returns `start` plus the turned vector v, which has zeros for most arms.
  ARMWRIGHT_INLINE Vec3<V> add(Vec3<V> start, const double (&v)[3]) const {
    if (v[0] != 0) {
      start = start + V(v[0]) * x;
    }
    if (v[1] != 0) {
      start = start + V(v[1]) * y;
    }
    if (v[2] != 0) {
      start = start + V(v[2]) * z;
    }
    return start;
  }
  // Turns about x. Most angles are multiples of a right angle.
  ARMWRIGHT_INLINE void tilt(double cosine, double sine) {
    if (sine == 0 && cosine == 1) {
      return;
    }
    const Vec3<V> old_y = y;
    if (cosine == 0) {
      y = V(sine) * z;
      z = V(-sine) * old_y;
    } else {
      y = V(cosine) * old_y + V(sine) * z;
      z = V(cosine) * z - V(sine) * old_y;
    }
  }
};

// The places of all joints and the tip in the world.
template <class V>
struct Posture {
  Vec3<V> axis[kMostJoints];
  Vec3<V> place[kMostJoints];
  Vec3<V> tip;
  Turn<V> turn;  // of the last joint's frame
};

template <class V>
ARMWRIGHT_INLINE void calc_posture(const Chain& chain, const V* q, Posture<V>& posture) {
  const V zero = 0.0;
  // The angles come first, because they do not wait for each other.
  V sines[kMostJoints], cosines[kMostJoints];
  for (int i = 0; i < chain.joints; ++i) {
    const ChainJoint& joint = chain.joint[i];
    const V turned = V(joint.turn_rad);
    calc_sine_cosine(joint.slides ? turned : q[i] + turned, sines[i], cosines[i]);
  }
  const V base_cos = chain.base_turn_cos, base_sin = chain.base_turn_sin;
  Turn<V> turn{{base_cos, base_sin, zero}, {-base_sin, base_cos, zero}, {zero, zero, V(1.0)}};
  Vec3<V> place{zero, zero, zero};
  for (int i = 0; i < chain.joints; ++i) {
    const ChainJoint& joint = chain.joint[i];
    place = turn.add(place, joint.place_m);
    turn.tilt(joint.tilt_cos, joint.tilt_sin);
    posture.axis[i] = turn.z;
    posture.place[i] = place;
    if (joint.slides) {
      place = place + (V(joint.unit_m) * q[i]) * turn.z;
    }
    const V sine = sines[i], cosine = cosines[i];
    const Vec3<V> y = turn.y;
    turn.y = cosine * y - sine * turn.x;
    turn.x = cosine * turn.x + sine * y;
  }
  posture.tip = turn.add(place, chain.tip_place_m);
  posture.turn = turn;
}

// Along a path, errors of the orientation are small. This is the largest square of the angle's sine
// for which calc_arc_over_sine() holds.
inline constexpr double kSmallSquare = 1e-4;

// Returns 1 in lanes where the angle is small, else 0. `cosine` has the sign of the angle's cosine.
template <class V>
ARMWRIGHT_INLINE V find_small(V sine_square, V cosine) {
  const V zero = 0.0, one = 1.0;
  return select(sine_square < V(kSmallSquare), select(cosine > zero, one, zero), zero);
}

// Returns the angle divided by its sine s: 1 + s^2/6 + 3 s^4/40 + 5 s^6/112 + 35 s^8/1152, with an
// error of at most 3e-22 for small angles.
template <class V>
ARMWRIGHT_INLINE V calc_arc_over_sine(V square) {
  return V(1.0) +
         square * (V(1.0 / 6) +
                   square * (V(3.0 / 40) + square * (V(5.0 / 112) + square * V(35.0 / 1152))));
}

// Returns the vector along the axis of the rotation `to` `from`^T, with the angle in [0, pi] as its
// length. The rows of `to` are those of a matrix. The formulas are those of a unit quaternion
// (Shepperd 1978, Quaternion from rotation matrix, Journal of Guidance and Control 1, 223-224).
template <class V>
ARMWRIGHT_INLINE Vec3<V> calc_rotation_vector(const V to[3][3], const Turn<V>& from) {
  V m[3][3];
#pragma GCC unroll 3
  for (int row = 0; row < 3; ++row) {
    m[row][0] = to[row][0] * from.x.x + to[row][1] * from.y.x + to[row][2] * from.z.x;
    m[row][1] = to[row][0] * from.x.y + to[row][1] * from.y.y + to[row][2] * from.z.y;
    m[row][2] = to[row][0] * from.x.z + to[row][1] * from.y.z + to[row][2] * from.z.z;
  }
  const V zero = 0.0, one = 1.0, half = 0.5;
  const Vec3<V> skew{m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
  const V trace = m[0][0] + m[1][1] + m[2][2];
  const V square = V(0.25) * dot(skew, skew);  // of the angle's sine
  const V is_small = find_small(square, trace - one);
  const Vec3<V> near = (half * calc_arc_over_sine(square)) * skew;
  if (lanes::find_less(is_small, half) == 0) {
    return near;
  }
  const auto small = trace > zero;
  const V root = sqrt(select(small, trace + one, one));
  V w = half * root;
  Vec3<V> v = (half / root) * skew;
  constexpr unsigned kAll = (1U << V::kLanes) - 1;
  if ((lanes::find_less(zero, trace) & kAll) != kAll) {  // a large angle in some lane
    const V large_x = sqrt(max(zero, one + m[0][0] - m[1][1] - m[2][2]));
    const V large_y = sqrt(max(zero, one + m[1][1] - m[2][2] - m[0][0]));
    const V large_z = sqrt(max(zero, one + m[2][2] - m[0][0] - m[1][1]));
    const V xy = m[1][0] + m[0][1], xz = m[2][0] + m[0][2], yz = m[2][1] + m[1][2];
    // The largest component comes first, so the divisor is not small.
    const auto y_over_x = m[1][1] > m[0][0];
    V largest = select(y_over_x, large_y, large_x);
    const V diagonal = select(y_over_x, m[1][1], m[0][0]);
    V from_w = select(y_over_x, skew.y, skew.x);
    Vec3<V> products{select(y_over_x, xy, zero), select(y_over_x, zero, xy),
                     select(y_over_x, yz, xz)};
    Vec3<V> own{select(y_over_x, zero, one), select(y_over_x, one, zero), zero};
    const auto z_over = m[2][2] > diagonal;
    largest = select(z_over, large_z, largest);
    from_w = select(z_over, skew.z, from_w);
    products = {select(z_over, xz, products.x), select(z_over, yz, products.y),
                select(z_over, zero, products.z)};
    own = {select(z_over, zero, own.x), select(z_over, zero, own.y), select(z_over, one, own.z)};
    const V scale = half / largest;
    w = select(small, w, from_w * scale);
    const auto component = [&](V of_small, V of_own, V product) __attribute__((always_inline)) {
      return select(small, of_small, half * largest * of_own + product * scale);
    };
    v = {component(v.x, own.x, products.x), component(v.y, own.y, products.y),
         component(v.z, own.z, products.z)};
  }
  const V length = sqrt(dot(v, v));
  const V angle = V(2.0) * calc_angle_above(length, abs(w));
  const V ratio = select(length > zero, angle / select(length > zero, length, one), zero);
  const Vec3<V> far = select(w < zero, -ratio, ratio) * v;
  const auto use_near = is_small > half;
  return {select(use_near, near.x, far.x), select(use_near, near.y, far.y),
          select(use_near, near.z, far.z)};
}

// Returns the rotation vector that turns the unit vector `is` to `should`.
template <class V>
ARMWRIGHT_INLINE Vec3<V> calc_swing(Vec3<V> is, Vec3<V> should) {
  const V zero = 0.0, one = 1.0;
  const Vec3<V> across = cross(is, should);
  const V square = dot(across, across);
  const V is_small = find_small(square, dot(is, should));
  const Vec3<V> near = calc_arc_over_sine(square) * across;
  if (lanes::find_less(is_small, V(0.5)) == 0) {
    return near;
  }
  const V sine = sqrt(square);
  const V angle = calc_angle_above(sine, dot(is, should));
  const auto turned = sine > zero;
  // Opposite directions: any perpendicular axis is right.
  const V flat = is.x * is.x + is.y * is.y;
  const auto is_steep = flat < V(1e-24);
  const V flat_length = sqrt(select(is_steep, one, flat));
  const V opposite = select(angle > one, angle, zero);
  const V ratio = angle / select(turned, sine, one);
  const auto use_near = is_small > V(0.5);
  const auto component = [&](V of_near, V of_across, V of_other) __attribute__((always_inline)) {
    return select(use_near, of_near, select(turned, ratio * of_across, opposite * of_other));
  };
  return {component(near.x, across.x, select(is_steep, one, -is.y / flat_length)),
          component(near.y, across.y, select(is_steep, zero, is.x / flat_length)),
          component(near.z, across.z, zero)};
}

// One system (J J^T + mu^2 1) y = b of kRows rows, factored as L D L^T.
template <class V, int kRows>
struct System {
  V lower[kRows][kRows];  // L below the diagonal
  V inverse[kRows];       // 1 / D

  // Factors the system. `columns` has one column of J per joint.
  ARMWRIGHT_INLINE void factor(const V (*columns)[kRows], int joints, V damping) {
#pragma GCC unroll 6
    for (int row = 0; row < kRows; ++row) {
      V sums[kRows];
#pragma GCC unroll 6
      for (int column = 0; column <= row; ++column) {
        sums[column] = V(0.0);
      }
      for (int i = 0; i < joints; ++i) {
        const V its = columns[i][row];
#pragma GCC unroll 6
        for (int column = 0; column <= row; ++column) {
          sums[column] += its * columns[i][column];
        }
      }
#pragma GCC unroll 6
      for (int column = 0; column <= row; ++column) {
        lower[row][column] = sums[column];
      }
      lower[row][row] += damping;
    }
#pragma GCC unroll 6
    for (int k = 0; k < kRows; ++k) {
      inverse[k] = V(1.0) / lower[k][k];
#pragma GCC unroll 6
      for (int row = kRows - 1; row > k; --row) {  // the rows above still need L D of this column
        const V factor = lower[row][k] * inverse[k];
#pragma GCC unroll 6
        for (int column = k + 1; column <= row; ++column) {
          lower[row][column] -= factor * lower[column][k];
        }
        lower[row][k] = factor;
      }
    }
  }
  ARMWRIGHT_INLINE void solve(V* y) const {
#pragma GCC unroll 6
    for (int row = 1; row < kRows; ++row) {
#pragma GCC unroll 6
      for (int column = 0; column < row; ++column) {
        y[row] -= lower[row][column] * y[column];
      }
    }
#pragma GCC unroll 6
    for (int row = kRows - 1; row >= 0; --row) {
      y[row] = y[row] * inverse[row];
#pragma GCC unroll 6
      for (int below = row + 1; below < kRows; ++below) {
        y[row] -= lower[below][row] * y[below];
      }
    }
  }
};

// V::kLanes searches, from lane `first` of a block.
template <class V, int kRows>
struct Search {
  explicit ARMWRIGHT_INLINE Search(const Chain& its) : chain(its), joints(its.joints) {}

  const Chain& chain;
  const int joints;
  V q[kMostJoints];
  V wish[kMostJoints];
  V column[kMostJoints][kRows];  // of J
  V step[kMostJoints];
  V y[kRows];
  V error[kRows];
  V error_square;
  V step_sum;  // of the magnitudes of all joints' steps
  V longest_step;
  V target[3];
  V target_turn[3][3];  // pose: of the last joint's frame
  Vec3<V> target_axis;  // pointing: of the tool
  Vec3<V> axis;

  ARMWRIGHT_INLINE void load_target(const Block& block, int first) {
#pragma GCC unroll 3
    for (int row = 0; row < 3; ++row) {
      target[row] = load<V>(block.position_m[row] + first);
    }
    if constexpr (kRows == 6) {
      V axis_of[3];
#pragma GCC unroll 3
      for (int row = 0; row < 3; ++row) {
        V its[3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
          its[i] = load<V>(block.turn[row][i] + first);
        }
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
          const auto& tip = chain.tip_turn[i];
          target_turn[row][i] = its[0] * V(tip[0]) + its[1] * V(tip[1]) + its[2] * V(tip[2]);
        }
        const auto& tool = chain.tool_axis;
        axis_of[row] = its[0] * V(tool[0]) + its[1] * V(tool[1]) + its[2] * V(tool[2]);
      }
      target_axis = {axis_of[0], axis_of[1], axis_of[2]};
    }
  }

  ARMWRIGHT_INLINE void calc_error(const Posture<V>& posture) {
    const V zero = 0.0;
    error[0] = target[0] - posture.tip.x;
    error[1] = target[1] - posture.tip.y;
    error[2] = target[2] - posture.tip.z;
    if constexpr (kRows == 6) {
      Vec3<V> turn;
      if (chain.orientation == ToolOrientation::pose) {
        turn = calc_rotation_vector(target_turn, posture.turn);
      } else {
        axis = posture.turn.add(Vec3<V>{zero, zero, zero}, chain.last_tool_axis);
        turn = calc_swing(axis, target_axis);
      }
      turn = V(chain.arm_m) * turn;
      error[3] = turn.x;
      error[4] = turn.y;
      error[5] = turn.z;
    }
    error_square = zero;
#pragma GCC unroll 6
    for (int row = 0; row < kRows; ++row) {
      error_square += error[row] * error[row];
    }
  }

  // Computes J. Returns mu^2.
  ARMWRIGHT_INLINE V calc_columns(const Posture<V>& posture) {
    const V zero = 0.0;
    V largest = zero;
    for (int i = 0; i < joints; ++i) {
      const bool slides = chain.joint[i].slides;
      Vec3<V> way = V(chain.joint[i].unit_m) * posture.axis[i];
      if (!slides) {
        way = cross(posture.axis[i], posture.tip - posture.place[i]);
      }
      column[i][0] = way.x;
      column[i][1] = way.y;
      column[i][2] = way.z;
      V square = dot(way, way);
      if constexpr (kRows == 6) {
        Vec3<V> turn{zero, zero, zero};
        if (!slides) {
          turn = posture.axis[i];
          if (chain.orientation == ToolOrientation::pointing) {
            turn = turn - dot(turn, axis) * axis;  // turns about the tool's axis are free
          }
          turn = V(chain.arm_m) * turn;
          square += dot(turn, turn);
        }
        column[i][3] = turn.x;
        column[i][4] = turn.y;
        column[i][5] = turn.z;
      }
      largest = max(largest, square);
    }
    return error_square + V(chain.least_damping) * largest;
  }

  // Computes the step of every joint from the given columns of J and the given error.
  ARMWRIGHT_INLINE void calc_step(const V (*columns)[kRows], const V* rest, V damping,
                                  bool has_wish) {
    System<V, kRows> system;
    system.factor(columns, joints, damping);
#pragma GCC unroll 6
    for (int row = 0; row < kRows; ++row) {
      y[row] = rest[row];
    }
    if (has_wish) {
      for (int i = 0; i < joints; ++i) {
#pragma GCC unroll 6
        for (int row = 0; row < kRows; ++row) {
          y[row] -= columns[i][row] * wish[i];
        }
      }
    }
    system.solve(y);
    for (int i = 0; i < joints; ++i) {
      V sum = wish[i];
#pragma GCC unroll 6
      for (int row = 0; row < kRows; ++row) {
        sum += columns[i][row] * y[row];
      }
      step[i] = sum;
    }
  }

  // Shortens the step of every joint where one is too long. Returns 1 in lanes where the step is
  // finite, else 0.
  ARMWRIGHT_INLINE V shorten() {
    V longest = 0.0;
    V sum = 0.0;  // shows a NaN, which max() may lose
    for (int i = 0; i < joints; ++i) {
      const V way = abs(step[i]);
      longest = max(longest, way);
      sum += way;
    }
    const auto is_long = longest > longest_step;
    const V factor = select(is_long, longest_step / select(is_long, longest, V(1.0)), V(1.0));
    for (int i = 0; i < joints; ++i) {
      step[i] = step[i] * factor;
    }
    step_sum = sum;
    return select(sum < V(1e300), V(1.0), V(0.0));
  }

  // Finds the joint that leaves its range by most, among those that are not held. Returns by how
  // much; 0 if none does.
  ARMWRIGHT_INLINE V find_worst(const V* is_free, V& worst) const {
    V farthest = 0.0;
    worst = -1.0;
    for (int i = 0; i < joints; ++i) {
      const V next = q[i] + step[i];
      const V beyond =
          select(is_free[i] > V(0.5),
                 max(next - V(chain.joint[i].upper), V(chain.joint[i].lower) - next), V(0.0));
      const auto is_worse = beyond > farthest;
      worst = select(is_worse, V(static_cast<double>(i)), worst);
      farthest = select(is_worse, beyond, farthest);
    }
    return farthest;
  }

  ARMWRIGHT_INLINE V clamp(int i, V position) const {
    return min(max(position, V(chain.joint[i].lower)), V(chain.joint[i].upper));
  }

  // Holds joints at the ends of their ranges and computes the step again, until no other joint
  // leaves its range. Lanes with live = 0 are left alone. Sets live = 0 where a step is not finite.
  ARMWRIGHT_INLINE void hold_joints(V damping, V& live) {
    const V zero = 0.0, one = 1.0, half = 0.5;
    V is_free[kMostJoints];
    V fixed[kMostJoints];
    V wished[kMostJoints];
    for (int i = 0; i < joints; ++i) {
      is_free[i] = one;
      fixed[i] = zero;
      wished[i] = wish[i];
    }
    V worst;
    V again = select(find_worst(is_free, worst) > zero, live, zero);
    while (lanes::find_less(half, again) != 0) {
      V columns[kMostJoints][kRows];
      V rest[kRows];
      V kept[kMostJoints];
#pragma GCC unroll 6
      for (int row = 0; row < kRows; ++row) {
        rest[row] = error[row];
      }
      for (int i = 0; i < joints; ++i) {
        const V at = static_cast<double>(i);
        kept[i] = step[i];
        const V is_new = select(again > half, select(abs(worst - at) < half, one, zero), zero);
        fixed[i] = select(is_new > half, clamp(i, q[i] + step[i]) - q[i], fixed[i]);
        is_free[i] = select(is_new > half, zero, is_free[i]);
        const auto is_held = is_free[i] < half;
#pragma GCC unroll 6
        for (int row = 0; row < kRows; ++row) {
          rest[row] -= column[i][row] * fixed[i];
          columns[i][row] = select(is_held, zero, column[i][row]);
        }
        wish[i] = select(is_held, fixed[i], wished[i]);
      }
      calc_step(columns, rest, damping, true);
      const V finite = shorten();
      for (int i = 0; i < joints; ++i) {
        step[i] = select(again > half, step[i], kept[i]);
      }
      live = select(again > half, live * finite, live);
      again = again * live;
      again = select(find_worst(is_free, worst) > zero, again, zero);
    }
    for (int i = 0; i < joints; ++i) {
      wish[i] = wished[i];
    }
  }

  // Makes one step in lanes with live = 1. Sets live = 0 where the step is not finite. Returns 1 in
  // lanes that are certain to be at the target, else 0.
  ARMWRIGHT_INLINE V improve(const Posture<V>& posture, bool has_wish, V& live) {
    const V zero = 0.0, one = 1.0;
    const V damping = calc_columns(posture);
    calc_step(column, error, damping, has_wish);
    live = live * shorten();
    if (chain.within_limits) {
      V farthest = zero;
      for (int i = 0; i < joints; ++i) {
        const V next = q[i] + step[i];
        farthest =
            max(farthest, max(next - V(chain.joint[i].upper), V(chain.joint[i].lower) - next));
      }
      if (lanes::find_less(zero, select(farthest > zero, live, zero)) != 0) {
        hold_joints(damping, live);
      }
    }
    const auto moves = live > zero;
    for (int i = 0; i < joints; ++i) {
      const V next = q[i] + step[i];
      // Rounding may leave a joint outside its range.
      q[i] = select(moves, chain.within_limits ? clamp(i, next) : next, q[i]);
    }
    // The step leaves e - J dq = mu^2 y of the error, and terms of second order: at most
    // s^2 (r + L) / 2 of the bent paths and |e| s of the turned axes, where s is the sum of all
    // joints' steps and r the arm's reach. The bound takes twice as much.
    V rest = zero;
#pragma GCC unroll 6
    for (int row = 0; row < kRows; ++row) {
      rest += y[row] * y[row];
    }
    const V half_tolerance = 0.5 * chain.tolerance_m;
    const V bent =
        V(2.0) * step_sum * (step_sum * V(chain.reach_m + chain.arm_m) + sqrt(error_square));
    return select(bent < half_tolerance,
                  select(damping * damping * rest < half_tolerance * half_tolerance, one, zero),
                  zero);
  }

  ARMWRIGHT_INLINE unsigned run(Block& block, int first) {
    const V zero = 0.0, one = 1.0, half = 0.5;
    for (int i = 0; i < joints; ++i) {
      q[i] = load<V>(block.q[i] + first);
      wish[i] = load<V>(block.wish[i] + first);
    }
    longest_step = load<V>(block.longest_step + first);
    const V iterations = load<V>(block.iterations + first);
    V live = select(iterations > half, one, zero);
    V reached = zero;
    const V tolerance = chain.tolerance_m * chain.tolerance_m;
    load_target(block, first);
    for (int pass = 0;; ++pass) {
      Posture<V> posture;
      calc_posture(chain, q, posture);
      calc_error(posture);
      if (pass > 0) {
        const V hit = select(error_square < tolerance, live, zero);
        reached += hit;
        live -= hit;
      }
      live = select(iterations > V(static_cast<double>(pass)), live, zero);
      if (lanes::find_less(half, live) == 0) {
        break;
      }
      const V sure = improve(posture, pass == 0, live);  // changes `live`
      const V certain = live * sure;
      reached += certain;
      live -= certain;
      if (lanes::find_less(half, live) == 0) {
        break;
      }
      if (pass == 0) {
        for (int i = 0; i < joints; ++i) {
          wish[i] = zero;
        }
      }
    }
    for (int i = 0; i < joints; ++i) {
      __builtin_memcpy(block.q[i] + first, &q[i], sizeof q[i]);
    }
    return lanes::find_less(half, reached) << first;
  }
};

// Implements Solve (posture_solver.hpp) for one lane type.
template <class V>
ARMWRIGHT_INLINE unsigned solve_lanes(const Chain& chain, Block& block) {
  unsigned reached = 0;
  for (int first = 0; first < kLanes; first += V::kLanes) {
    bool is_used = false;
    for (int lane = first; lane < first + V::kLanes; ++lane) {
      is_used |= block.iterations[lane] > 0;
    }
    if (!is_used) {
      continue;
    }
    if (chain.orientation == ToolOrientation::free) {
      reached |= Search<V, 3>(chain).run(block, first);
    } else {
      reached |= Search<V, 6>(chain).run(block, first);
    }
  }
  return reached;
}

}  // namespace armwright::postures
