// Sine, cosine and rounding for all lanes at once, without branches and tables.
//
// Range: |x| <= 1e6 (double), 1e4 (float). Beyond it the result is wrong, and far beyond it is not
// finite. The engine treats a joint that has turned farther as diverged.
//
// Error within the range: at most two units in the last place of the larger of sine and cosine. The
// absolute error is at most 2.2e-16 (double) or 9e-8 (float).
//
// Method: the argument is reduced to [-pi/4, pi/4] by subtracting multiples of pi/2, which is
// stored in three parts. The first two parts have at least 20 (float: 13) trailing zero bits, so
// their products with the quadrant's number are exact (Cody and Waite 1980). The polynomial
// coefficients are those of fdlibm's sine and cosine kernels for double (Sun Microsystems 1993) and
// of Cephes' sinf and cosf for float (Moshier 1992).
#pragma once

#include "sim/simd/lane_pack.hpp"

namespace armwright::lanes {

// The constant that rounds to the nearest integer (ties to even) for |x| < 2^51 (double), 2^22
// (float). After adding 1.5 x 2^52 (float: 1.5 x 2^23) the sum has no bits left for a fraction.
template <class T>
inline constexpr T kRounder = T{6755399441055744.0};
template <>
inline constexpr float kRounder<float> = 12582912.0F;

// Returns x rounded to the nearest integer, in the range of kRounder.
template <class V>
ARMWRIGHT_INLINE V round_to_integer(V x) {
  const V rounder = kRounder<typename V::Scalar>;
  return (x + rounder) - rounder;
}

// Returns the integer part of x, which must be within the range of an int.
template <class T>
ARMWRIGHT_INLINE int to_integer(T x) {
  return static_cast<int>(x);
}

// Returns x minus the nearest multiple of 2 pi. Returns exactly x if |x| < pi.
template <class V>
ARMWRIGHT_INLINE V wrap(V x) {
  using T = typename V::Scalar;
  constexpr auto kTurn = static_cast<T>(6.283185307179586476925287);
  return x - round_to_integer(x * V(T{1} / kTurn)) * V(kTurn);
}

namespace detail {

template <class V>
ARMWRIGHT_INLINE V calc_sine_polynomial(V x, V z, double) {
  const V high =
      V(8.33333333332248946124e-03) +
      z * (V(-1.98412698298579493134e-04) +
           z * (V(2.75573137070700676789e-06) +
                z * (V(-2.50507602534068634195e-08) + z * V(1.58969099521155010221e-10))));
  return x + x * z * (V(-1.66666666666666324348e-01) + z * high);
}
template <class V>
ARMWRIGHT_INLINE V calc_cosine_polynomial(V z, double) {
  const V high = V(2.48015872894767294178e-05) +
                 z * (V(-2.75573143513906633035e-07) +
                      z * (V(2.08757232129817482790e-09) + z * V(-1.13596475577881948265e-11)));
  return V(1.0) + z * (V(-0.5) + z * (V(4.16666666666666019037e-02) +
                                      z * (V(-1.38888888888741095749e-03) + z * high)));
}
template <class V>
ARMWRIGHT_INLINE V calc_sine_polynomial(V x, V z, float) {
  return x + x * z * (V(-1.6666654611e-1F) + z * (V(8.3321608736e-3F) + z * V(-1.9515295891e-4F)));
}
template <class V>
ARMWRIGHT_INLINE V calc_cosine_polynomial(V z, float) {
  return V(1.0F) +
         z * (V(-0.5F) + z * (V(4.166664568298827e-2F) +
                              z * (V(-1.388731625493765e-3F) + z * V(2.443315711809948e-5F))));
}

template <class T>
inline constexpr T kHalfPi[] = {1.57079632673412561417e+00, 6.07710050630396597660e-11,
                                2.02226624879595063154e-21};
template <>
inline constexpr float kHalfPi<float>[] = {1.5703125F, 4.837512969970703125e-4F,
                                           7.54978995489188216e-8F};

// Turns the sine s and cosine c of the reduced argument into those of the argument: swaps them in
// odd quadrants and sets their signs. The lowest bits of `rounded` hold the quadrant's number as an
// integer.
template <class T, int W, class Isa>
ARMWRIGHT_INLINE void place_in_quadrant(Pack<T, W, Isa> rounded, Pack<T, W, Isa>& s,
                                        Pack<T, W, Isa>& c) {
  using P = Pack<T, W, Isa>;
  using Mask = typename P::Mask;
  using Vector = typename P::Vector;
  constexpr int kToSign = 8 * sizeof(T) - 2;
  const Mask quadrant = reinterpret_cast<Mask>(rounded.v);
  const Mask odd = (quadrant & 1) != 0;
  const Vector sine = odd ? c.v : s.v;
  const Vector cosine = odd ? s.v : c.v;
  s.v = reinterpret_cast<Vector>(reinterpret_cast<Mask>(sine) ^ ((quadrant & 2) << kToSign));
  c.v =
      reinterpret_cast<Vector>(reinterpret_cast<Mask>(cosine) ^ (((quadrant + 1) & 2) << kToSign));
}
template <class P>
ARMWRIGHT_INLINE void place_in_quadrant(Pair<P> rounded, Pair<P>& s, Pair<P>& c) {
  place_in_quadrant(rounded.first, s.first, c.first);
  place_in_quadrant(rounded.second, s.second, c.second);
}
template <class T, class Isa>
ARMWRIGHT_INLINE void place_in_quadrant(Single<T, Isa> rounded, Single<T, Isa>& s,
                                        Single<T, Isa>& c) {
  const auto quadrant = __builtin_bit_cast(typename Bits<T>::Type, rounded.v);
  const T sine = (quadrant & 1) != 0 ? c.v : s.v;
  const T cosine = (quadrant & 1) != 0 ? s.v : c.v;
  s.v = (quadrant & 2) != 0 ? -sine : sine;
  c.v = ((quadrant + 1) & 2) != 0 ? -cosine : cosine;
}

}  // namespace detail

// Computes sine and cosine of x (rad) in every lane; range and error as stated at the top.
template <class V>
ARMWRIGHT_INLINE void calc_sine_cosine(V x, V& sine, V& cosine) {
  using T = typename V::Scalar;
  const V rounded = x * V(static_cast<T>(0.636619772367581343076)) + V(kRounder<T>);
  const V quadrant = rounded - V(kRounder<T>);
  const V reduced =
      ((x - quadrant * V(detail::kHalfPi<T>[0])) - quadrant * V(detail::kHalfPi<T>[1])) -
      quadrant * V(detail::kHalfPi<T>[2]);
  const V square = reduced * reduced;
  sine = detail::calc_sine_polynomial(reduced, square, T{});
  cosine = detail::calc_cosine_polynomial(square, T{});
  detail::place_in_quadrant(rounded, sine, cosine);
}

}  // namespace armwright::lanes
