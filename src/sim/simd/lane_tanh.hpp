// The hyperbolic tangent for every lane type, from + - x / alone, so that it also works on numbers
// that carry derivatives.
//
// tanh(x) = n / d of y = x / 8 by Lambert's continued fraction, truncated after its seventh level,
//   (135135 y + 17325 y^3 + 378 y^5 + y^7) / (135135 + 62370 y^2 + 3150 y^4 + 28 y^6),
// then doubled three times: tanh 2y = 2 n d / (d^2 + n^2). Arguments beyond 20 count as 20, where
// the value is 1 to the last bit of a double. Error: at most 1e-15, or 1e-6 on lanes of float.
#pragma once

#include "sim/simd/lane_pack.hpp"

namespace armwright::lanes {

// A quotient that is not yet divided. Several of them can share one division.
template <class V>
struct Fraction {
  V n, d;
};

// Returns tanh(x). Its denominator is at least 1 and at most 1e8.
template <class V>
ARMWRIGHT_INLINE Fraction<V> calc_tanh_fraction(V x) {
  using T = typename V::Scalar;
  const auto constant = [](double value) __attribute__((always_inline)) {
    return V(static_cast<T>(value));
  };
  const V y = min(constant(20), max(constant(-20), x)) * constant(0.125);
  const V square = y * y;
  // In units of 135135, so that squares of squares stay within the range of a float.
  V n =
      y * (V(1) + square * (constant(17325.0 / 135135) +
                            square * (constant(378.0 / 135135) + square * constant(1.0 / 135135))));
  V d = V(1) + square * (constant(62370.0 / 135135) +
                         square * (constant(3150.0 / 135135) + square * constant(28.0 / 135135)));
  for (int k = 0; k < 3; ++k) {
    const V both = n * d;
    d = d * d + n * n;
    n = both + both;
  }
  return {n, d};
}

template <class V>
ARMWRIGHT_INLINE V calc_tanh(V x) {
  const Fraction<V> fraction = calc_tanh_fraction(x);
  return fraction.n / fraction.d;
}

}  // namespace armwright::lanes
