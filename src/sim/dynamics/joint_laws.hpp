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

namespace armwright::articulated {

// The numbers of one joint's dry friction.
template <class V>
struct FrictionNumbers {
  V breakaway;           // c + s_t
  V stribeck;            // s_t
  V inverse_transition;  // 1 / v_w
  V inverse_stribeck;    // 1 / v_s
};

// A quotient that is not yet divided, so that several can share one division.
template <class V>
struct Fraction {
  V n, d;
};

// Returns tanh(x) for x >= 0 with a relative error of at most 3.1e-8, as a quotient of polynomials
// of x^2 (a fit of least largest error on [0, 9]). Arguments beyond 9 count as 9. The denominator is
// at least 1 and at most 417.
template <class V>
ARMWRIGHT_INLINE Fraction<V> calc_saturation(V x) {
  using T = typename V::Scalar;
  const auto constant = [](double value) __attribute__((always_inline)) {
    return V(static_cast<T>(value));
  };
  const V y = min(constant(9), x);
  const V s = y * y;
  return {
      y * (constant(0.9999999794557656) +
           s * (constant(0.1338102214186583) +
                s * (constant(0.003495583970511233) + s * (constant(2.0609013493142966e-05) +
                                                           s * constant(1.3354564836477197e-08))))),
      V(1) + s * (constant(0.4671433773371843) + s * (constant(0.025876966396085166) +
                                                      s * (constant(0.0003285628005775641) +
                                                           s * constant(7.776519040084557e-07))))};
}

// Returns phi - d. `has_stribeck`: s_t may differ from 0. Without it the result has fewer operations
// and other last bits, so all steps of a simulation must agree on it.
template <class V>
ARMWRIGHT_INLINE Fraction<V> calc_friction_chord(const FrictionNumbers<V>& its, V rate,
                                                 bool has_stribeck) {
  using T = typename V::Scalar;
  // At rest the chord is the tangent: there tanh(x) / x is 1.
  const V speed = max(abs(rate), V(static_cast<T>(1e-30)));
  const Fraction<V> rise = calc_saturation(speed * its.inverse_transition);
  if (!has_stribeck) {
    return {its.breakaway * rise.n, rise.d * speed};
  }
  const Fraction<V> fall = calc_saturation(speed * its.inverse_stribeck);
  return {its.breakaway * rise.n * fall.d - its.stribeck * fall.n * rise.d,
          rise.d * fall.d * speed};
}

// The efforts of a counterbalance, as the kernels need them.
struct BalanceGrid {
  double middle;        // of the joint's range; whole turns are left out around it
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
  const V first = lanes::round_to_integer(max(place - constant(0.5), V(0)));
  alignas(64) T numbers[V::kLanes];
  alignas(64) T below[V::kLanes];
  alignas(64) T above[V::kLanes];
  *reinterpret_cast<V*>(numbers) = min(first, constant(grid.last - 1));
  for (int lane = 0; lane < V::kLanes; ++lane) {
    const double* const efforts = grid.efforts + lanes::to_integer(numbers[lane]);
    below[lane] = static_cast<T>(efforts[0]);
    above[lane] = static_cast<T>(efforts[1]);
  }
  const V low = *reinterpret_cast<const V*>(below);
  return low + (place - *reinterpret_cast<const V*>(numbers)) *
                   (*reinterpret_cast<const V*>(above) - low);
}

}  // namespace armwright::articulated
