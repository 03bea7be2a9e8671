// One lane of numbers that carry derivatives along: the lane type (lane_pack.hpp) that runs the
// dynamics on lanes::Dual (dual.hpp), ceres::Jet or the like. Where the dynamics have a kink, the
// derivatives are those of the branch that the value takes:
//   min, max, select   the number that is chosen; where two are equal, the second
//   abs                either side; at zero that of positive numbers
//   wrap               those of the argument: the turns that are left out are constant
//   comparisons        of the values alone; what is counted by them has no derivative
// The values are the same as on a lane of double.
//
// The dynamics find these functions only if they are declared first, so this header includes the
// dynamics, at its end; where it comes too late, nothing compiles.
#pragma once

#include "sim/simd/lane_math.hpp"

namespace armwright::lanes {

// To be specialised for each type of number, which also needs + - * / and to be made of a double:
//   static double get_value(const Number&);
//   static Number calc(double value, double slope, const Number& x);  // f(x), its derivatives
//                                                                     // slope times those of x
template <class Number>
struct Carrier;

template <class Number>
struct NumberLane {
  using Scalar = NumberLane;
  static constexpr int kLanes = 1;
  Number v;

  NumberLane() = default;
  ARMWRIGHT_INLINE NumberLane(double constant) : v(constant) {}
  ARMWRIGHT_INLINE explicit NumberLane(const Number& number) : v(number) {}
  ARMWRIGHT_INLINE double value() const { return Carrier<Number>::get_value(v); }
};

#define ARMWRIGHT_NUMBER \
  template <class N>     \
  ARMWRIGHT_INLINE
ARMWRIGHT_NUMBER NumberLane<N> operator+(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v + b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator-(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v - b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator*(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v * b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator/(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v / b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator-(const NumberLane<N>& a) {
  return NumberLane<N>(-a.v);
}
ARMWRIGHT_NUMBER NumberLane<N>& operator+=(NumberLane<N>& a, const NumberLane<N>& b) {
  return a = a + b;
}
ARMWRIGHT_NUMBER NumberLane<N>& operator-=(NumberLane<N>& a, const NumberLane<N>& b) {
  return a = a - b;
}
ARMWRIGHT_NUMBER bool operator<(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a.value() < b.value();
}
ARMWRIGHT_NUMBER bool operator>(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a.value() > b.value();
}
ARMWRIGHT_NUMBER NumberLane<N> select(bool mask, const NumberLane<N>& yes,
                                      const NumberLane<N>& no) {
  return mask ? yes : no;
}
ARMWRIGHT_NUMBER NumberLane<N> abs(const NumberLane<N>& a) {
  return a.value() < 0 ? -a : a;
}
ARMWRIGHT_NUMBER NumberLane<N> min(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a < b ? a : b;
}
ARMWRIGHT_NUMBER NumberLane<N> max(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a > b ? a : b;
}
ARMWRIGHT_NUMBER std::uint32_t find_less(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a < b ? 1 : 0;
}

// The general functions of lane_math.hpp round, which would lose derivatives.
struct NoRounding {};
template <class N>
inline constexpr NoRounding kRounder<NumberLane<N>>{};

struct NumberLevel;
ARMWRIGHT_NUMBER NumberLane<N> wrap(const NumberLane<N>& x) {
  const auto wrapped = wrap(Single<double, NumberLevel>(x.value()));
  return NumberLane<N>(Carrier<N>::calc(wrapped.v, 1, x.v));
}
ARMWRIGHT_NUMBER void calc_sine_cosine(const NumberLane<N>& x, NumberLane<N>& sine,
                                       NumberLane<N>& cosine) {
  Single<double, NumberLevel> s;
  Single<double, NumberLevel> c;
  calc_sine_cosine(Single<double, NumberLevel>(x.value()), s, c);
  sine = NumberLane<N>(Carrier<N>::calc(s.v, c.v, x.v));
  cosine = NumberLane<N>(Carrier<N>::calc(c.v, -s.v, x.v));
}
#undef ARMWRIGHT_NUMBER

}  // namespace armwright::lanes

#include "sim/engines/articulated/lane_kernel.hpp"

namespace armwright::articulated {

template <class N>
inline constexpr double kFarthest<lanes::NumberLane<N>> = kFarthest<double>;

}  // namespace armwright::articulated
