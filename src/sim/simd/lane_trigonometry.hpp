// Square root and the angle of a point for all lanes at once, without branches and tables.
//
// The code uses only operations that IEEE 754 rounds correctly, in the same order for every lane
// type. It must be compiled without fused multiply-add. Then the results have the same bits for any
// number of lanes and on any machine.
#pragma once

#include "sim/simd/lane_pack.hpp"

namespace armwright::lanes {

template <int W, class Isa>
ARMWRIGHT_INLINE Pack<double, W, Isa> sqrt(Pack<double, W, Isa> a) {
#if defined(__x86_64__)
  if constexpr (W == 2) {
    return _mm_sqrt_pd(a.v);
  }
#if defined(__AVX__)
  else if constexpr (W == 4) {
    return _mm256_sqrt_pd(a.v);
  }
#endif
#if defined(__AVX512F__)
  else if constexpr (W == 8) {
    return _mm512_sqrt_pd(a.v);
  }
#endif
#endif
  for (int i = 0; i < W; ++i) {
    a.v[i] = __builtin_sqrt(a.v[i]);
  }
  return a;
}
template <class Isa>
ARMWRIGHT_INLINE Single<double, Isa> sqrt(Single<double, Isa> a) {
  return __builtin_sqrt(a.v);
}

template <class P>
ARMWRIGHT_INLINE Pair<P> sqrt(Pair<P> a) {
  return {sqrt(a.first), sqrt(a.second)};
}

// Returns a with its sign changed in lanes where b is negative (-0 counts as negative).
template <int W, class Isa>
ARMWRIGHT_INLINE Pack<double, W, Isa> flip_sign(Pack<double, W, Isa> a, Pack<double, W, Isa> b) {
  using P = Pack<double, W, Isa>;
  using Mask = typename P::Mask;
  return reinterpret_cast<typename P::Vector>(reinterpret_cast<Mask>(a.v) ^
                                              (reinterpret_cast<Mask>(b.v) & (INT64_MIN - Mask{})));
}
template <class Isa>
ARMWRIGHT_INLINE Single<double, Isa> flip_sign(Single<double, Isa> a, Single<double, Isa> b) {
  return __builtin_signbit(b.v) ? -a.v : a.v;
}
template <class P>
ARMWRIGHT_INLINE Pair<P> flip_sign(Pair<P> a, Pair<P> b) {
  return {flip_sign(a.first, b.first), flip_sign(a.second, b.second)};
}

namespace detail {

// Returns atan(x) for |x| <= 7/16, with an error of at most 1 unit in the last place. Coefficients:
// fdlibm's atan (Sun Microsystems 1993).
template <class V>
ARMWRIGHT_INLINE V calc_atan_polynomial(V x) {
  const V z = x * x;
  const V w = z * z;
  const V even =
      z *
      (V(3.33333333333329318027e-01) +
       w * (V(1.42857142725034663711e-01) +
            w * (V(9.09088713343650656196e-02) +
                 w * (V(6.66107313738753120669e-02) +
                      w * (V(4.97687799461593236017e-02) + w * V(1.62858201153657823623e-02))))));
  const V odd =
      w * (V(-1.99999999998764832476e-01) +
           w * (V(-1.11111104054623557880e-01) +
                w * (V(-7.69187620504482999495e-02) +
                     w * (V(-5.83357013379057348645e-02) + w * V(-3.65315727442169155270e-02)))));
  return x - x * (even + odd);
}

}  // namespace detail

// Returns the angle (rad) of the point (x, y) with y >= +0, in [0, pi], and 0 at the origin. |x|
// and y are at most 8e307. Error: at most 4e-16 absolute; also at most 4e-16 relative if the angle
// is below pi/8 and y/x is not subnormal.
//
// Method: the point is mirrored into the octant 0 <= y <= x. If its angle there exceeds pi/8, it is
// turned back by pi/4. The ratio is then at most tan(pi/8), and one division is enough. The result
// is a multiple of pi/4 plus or minus the arc tangent of that ratio.
template <class V>
ARMWRIGHT_INLINE V calc_angle_above(V y, V x) {
  static_assert(sizeof(typename V::Scalar) == sizeof(double));
  constexpr double kTanEighthPi = 0.41421356237309504880;
  constexpr double kSmallest = 4.9406564584124654e-324;  // avoids 0 / 0 at the origin
  // pi/4 in two parts. The first has three trailing zero bits, so its multiples are exact.
  constexpr double kEighthHigh = 7.85398163397448278999e-01;
  constexpr double kEighthLow = 3.06161699786838301793e-17;
  const V zero = 0.0;
  const V width = flip_sign(x, x);
  // min() and max() return their second argument if one is NaN, so a NaN reaches the result.
  const V small = min(width, y);
  const V large = max(y, width);

  const auto middle = small > large * V(kTanEighthPi);
  V ratio = select(middle, small - large, small) /
            max(V(kSmallest), select(middle, small + large, large));
  V eighths = select(middle, V(1.0), zero);
  const auto steep = y > width;
  ratio = select(steep, -ratio, ratio);
  eighths = select(steep, V(2.0) - eighths, eighths);
  const auto left = x < zero;
  ratio = select(left, -ratio, ratio);
  eighths = select(left, V(4.0) - eighths, eighths);

  const V rest = detail::calc_atan_polynomial(ratio);
  return eighths * V(kEighthHigh) + (eighths * V(kEighthLow) + rest);
}

// Returns the angle (rad) of any point, in [-pi, pi], with the sign of y. x = -0 counts as 0.
template <class V>
ARMWRIGHT_INLINE V calc_atan2(V y, V x) {
  return flip_sign(calc_angle_above(flip_sign(y, y), x), y);
}

}  // namespace armwright::lanes
