// A small network for every joint, as in the thesis's class diagram beside the PID:
//   z_j = tanh(wj_error e / 0.1 + wj_integral S / 0.1 + wj_rate r / 1 + wj_bias),  j = 1, 2, 3,
//   u = L (v_bias + v1 z_1 + v2 z_2 + v3 z_3),
// with e (rad), S = sum(e) h (rad s) and r = (e - e_prev) / h (rad/s) in these units, and L the
// larger effort limit. Weights have either sign. It starts as a PID that saturates softly: unit j
// gets one input only, with v_j = 4. Each tanh is then at 1/4 where u = L, and there it is straight
// to 2 %.
// It has no hold(): a sum of tanh may reach an effort at several values of S or at none.
//
// docs/controllers.md uses it as the example of a controller that one file adds.
#pragma once

#include "sim/controllers/law.hpp"
#include "sim/simd/lane_pack.hpp"

namespace armwright::controllers {

// Returns the hyperbolic tangent for every lane type, from + - x / alone, so that it also works on
// numbers that carry derivatives.
//
// tanh(x) = n / d of y = x / 8 by Lambert's continued fraction, truncated after its seventh level,
//   (135135 y + 17325 y^3 + 378 y^5 + y^7) / (135135 + 62370 y^2 + 3150 y^4 + 28 y^6),
// then doubled three times, tanh 2y = 2 n d / (d^2 + n^2), with one division at the end. Arguments
// beyond 20 count as 20, where the value is 1 to the last bit of a double. Error: at most 1e-15, or
// 1e-6 on lanes of float.
template <class V>
ARMWRIGHT_INLINE V calc_tanh(V x) {
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
  return n / d;
}

struct Neural {
  static constexpr const char* kName = "neural";
  static constexpr const char* kSummary =
      "a network of three tanh units per joint, from the error, its integral and its rate";
  static constexpr const char* kFormula =
      "u = L (v_bias + sum_j vj tanh(wj_error e / 0.1 rad + wj_integral sum(e) h / 0.1 rad s + "
      "wj_rate (e - e_prev) / h / 1 rad/s + wj_bias)), L the larger effort limit";
  static constexpr double kWeights = 2;  // how far from its start a weight may go
  static constexpr double kOutputs = 4;
  static constexpr Gain kGains[] = {{"w1_error", "w1_error", "1", kWeights, true},
                                    {"w1_integral", "w1_integral", "1", kWeights, true},
                                    {"w1_rate", "w1_rate", "1", kWeights, true},
                                    {"w1_bias", "w1_bias", "1", kWeights, true},
                                    {"w2_error", "w2_error", "1", kWeights, true},
                                    {"w2_integral", "w2_integral", "1", kWeights, true},
                                    {"w2_rate", "w2_rate", "1", kWeights, true},
                                    {"w2_bias", "w2_bias", "1", kWeights, true},
                                    {"w3_error", "w3_error", "1", kWeights, true},
                                    {"w3_integral", "w3_integral", "1", kWeights, true},
                                    {"w3_rate", "w3_rate", "1", kWeights, true},
                                    {"w3_bias", "w3_bias", "1", kWeights, true},
                                    {"v1", "v1", "1", kOutputs, true},
                                    {"v2", "v2", "1", kOutputs, true},
                                    {"v3", "v3", "1", kOutputs, true},
                                    {"v_bias", "v_bias", "1", 1, true}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 2;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static constexpr int kUnits = 3;
  static constexpr double kError = 0.1;     // rad
  static constexpr double kIntegral = 0.1;  // rad s
  static constexpr double kRate = 1;        // rad/s

  static void convert(const PidStart& pid, double* own) {
    constexpr double kFirstOutput = 4;
    for (int k = 0; k < kGainCount<Neural>; ++k) {
      own[k] = 0;
    }
    const double scaled[] = {pid.p * kError, pid.i * kIntegral, pid.d * kRate};
    for (int unit = 0; unit < kUnits; ++unit) {
      own[4 * unit + unit] = scaled[unit] / (kFirstOutput * pid.effort_limit);
      own[4 * kUnits + unit] = kFirstOutput;
    }
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    using T = typename V::Scalar;
    state[0] = in.integrate(state[0], in.error);
    const V error = in.error * V(static_cast<T>(1 / kError));
    const V integral = state[0] * V(static_cast<T>(1 / kIntegral));
    const V rate =
        in.calc_rate(update_change(in, in.error, state[1])) * V(static_cast<T>(1 / kRate));
    V sum = gain[5 * kUnits];
    for (int unit = 0; unit < kUnits; ++unit) {
      const int first = 4 * unit;
      const V z = gain[first] * error + gain[first + 1] * integral + gain[first + 2] * rate +
                  gain[first + 3];
      sum += gain[4 * kUnits + unit] * calc_tanh(z);
    }
    return in.effort_limit * sum;
  }
};

}  // namespace armwright::controllers
