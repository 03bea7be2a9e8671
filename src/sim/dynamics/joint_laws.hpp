// The friction and the counterbalance of a joint (sim/robot/joint_plant.hpp) on lanes.
//
// Friction is given as the slope of a chord, f(v) = o + phi(v) v,
//   phi(v) = d + ((c + s_t) tanh(|v| / v_w) - s_t tanh(|v| / v_s)) / |v|.
// One step of length h is implicit in the rate along this chord,
//   (M + A + h phi(v_n)) (v_(n+1) - v_n) / h = u + s(q) - o - phi(v_n) v_n - b,
// so that friction never drives a joint, however large h phi is. phi >= 0 because v_w <= v_s and
// s_t >= -c. A joint that sticks creeps as it does in continuous time.
//
// This header is compiled for every instruction set (lane_pack.hpp), so it must not use templates
// of the standard library.
#pragma once

#include "sim/simd/lane_math.hpp"
#include "sim/simd/lane_tanh.hpp"

namespace armwright::articulated {

// The numbers of one joint's friction.
template <class V>
struct FrictionNumbers {
  V viscous;             // d
  V breakaway;           // c + s_t
  V stribeck;            // s_t
  V inverse_transition;  // 1 / v_w
  V inverse_stribeck;    // 1 / v_s
};

// Returns phi. `has_stribeck`: s_t may differ from 0. Without it the result has fewer operations
// and other last bits, so all steps of a simulation must agree on it.
template <class V>
ARMWRIGHT_INLINE V calc_friction_chord(const FrictionNumbers<V>& its, V rate, bool has_stribeck) {
  using T = typename V::Scalar;
  // At rest the chord is the tangent: there tanh(x) / x is 1 to the last bit.
  const V speed = max(abs(rate), V(static_cast<T>(1e-30)));
  const lanes::Fraction<V> rise = lanes::calc_tanh_fraction(speed * its.inverse_transition);
  if (!has_stribeck) {
    return its.viscous + its.breakaway * rise.n / (rise.d * speed);
  }
  const lanes::Fraction<V> fall = lanes::calc_tanh_fraction(speed * its.inverse_stribeck);
  return its.viscous + (its.breakaway * rise.n * fall.d - its.stribeck * fall.n * rise.d) /
                           (rise.d * fall.d * speed);
}

// The efforts of a counterbalance, as the kernels need them.
struct BalanceGrid {
  double middle;        // of the range; whole turns are left out around it
  double lower;         // the position of the first effort
  double inverse_step;  // efforts per rad or m
  int last;             // the number of the last effort, from 0
  const double* efforts;
};

// Returns the counterbalance's effort s(q).
template <class V>
ARMWRIGHT_INLINE V calc_balance(const BalanceGrid& grid, V position, bool slides) {
  using T = typename V::Scalar;
  const auto constant = [](double value) __attribute__((always_inline)) {
    return V(static_cast<T>(value));
  };
  const V from_middle = position - constant(grid.middle);
  const V turned = slides ? from_middle : lanes::wrap(from_middle);
  const V place =
      min(max((turned + constant(grid.middle - grid.lower)) * constant(grid.inverse_step), V(0)),
          constant(grid.last));  // 0 for NaN
  alignas(64) T places[V::kLanes];
  alignas(64) T values[V::kLanes];
  *reinterpret_cast<V*>(places) = place;
  for (int lane = 0; lane < V::kLanes; ++lane) {
    const int at = lanes::to_integer(places[lane]);
    const int first = at < grid.last ? at : grid.last - 1;
    const T below = static_cast<T>(grid.efforts[first]);
    const T rise = static_cast<T>(grid.efforts[first + 1] - grid.efforts[first]);
    values[lane] = below + (places[lane] - static_cast<T>(first)) * rise;
  }
  return *reinterpret_cast<const V*>(values);
}

}  // namespace armwright::articulated
