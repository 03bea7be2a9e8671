// A number with its derivatives along some directions, all of them carried through every operation
// (forward accumulation; Wengert 1964, A simple automatic derivative evaluation program): the same
// as ceres::Jet, but without a library and with the derivatives in a pack of SIMD lanes.
#pragma once

#include "sim/engines/articulated/number_lane.hpp"

namespace armwright::lanes {

// P: a pack of doubles, one lane a direction.
template <class P>
struct Dual {
  double value;
  P slopes;

  Dual() = default;
  ARMWRIGHT_INLINE Dual(double constant) : value(constant), slopes(0.0) {}
  ARMWRIGHT_INLINE Dual(double v, P s) : value(v), slopes(s) {}
};

#define ARMWRIGHT_DUAL \
  template <class P>   \
  ARMWRIGHT_INLINE Dual<P>
ARMWRIGHT_DUAL operator+(const Dual<P>& a, const Dual<P>& b) {
  return {a.value + b.value, a.slopes + b.slopes};
}
ARMWRIGHT_DUAL operator-(const Dual<P>& a, const Dual<P>& b) {
  return {a.value - b.value, a.slopes - b.slopes};
}
ARMWRIGHT_DUAL operator*(const Dual<P>& a, const Dual<P>& b) {
  return {a.value * b.value, P(a.value) * b.slopes + a.slopes * P(b.value)};
}
ARMWRIGHT_DUAL operator/(const Dual<P>& a, const Dual<P>& b) {
  const double inverse = 1 / b.value;
  const double quotient = a.value / b.value;
  return {quotient, (a.slopes - P(quotient) * b.slopes) * P(inverse)};
}
ARMWRIGHT_DUAL operator-(const Dual<P>& a) {
  return {-a.value, -a.slopes};
}
#undef ARMWRIGHT_DUAL

template <class P>
struct Carrier<Dual<P>> {
  ARMWRIGHT_INLINE static double get_value(const Dual<P>& number) { return number.value; }
  ARMWRIGHT_INLINE static Dual<P> calc(double value, double slope, const Dual<P>& number) {
    return {value, P(slope) * number.slopes};
  }
};

}  // namespace armwright::lanes
