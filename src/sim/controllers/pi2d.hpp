// A PID with a second integrator, which the thesis proposed for ramps but did not test:
//   S_k = S_(k-1) + e_k h,   SS_k = SS_(k-1) + S_k h,
//   u = P e + I S + I2 SS + D (e - e_prev) / h.
// Neither integral grows after a clamped step. Converted from a PID it starts with I2 = 0.1 I per
// second.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct Pi2d {
  static constexpr const char* kName = "pi2d";
  static constexpr const char* kSummary =
      "PID with a second integrator, against errors that grow steadily";
  static constexpr const char* kFormula =
      "u = p e + i S + i2 SS + d (e - e_prev) / h, S = sum(e) h, SS = sum(S) h";
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"i2", "i2_n_m_per_rad_s2", "N m/(rad s^2)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 3;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& pid, double* own) {
    constexpr double kFirstShare_per_s = 0.1;
    own[0] = pid.p;
    own[1] = pid.i;
    own[2] = kFirstShare_per_s * pid.i;
    own[3] = pid.d;
  }

  // The second integral holds the effort: it grows as long as the first one is not 0.
  template <class V>
  static void hold(V effort, Fields<V> gain, Fields<V> state) {
    state[2] = calc_integral(effort, gain[2]);
    state[0] = select(abs(gain[2]) > V(0), V(0), calc_integral(effort, gain[1]));
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    const V pid = calc_pid(in, gain[0], gain[1], gain[3], state);
    state[2] = in.integrate(state[2], state[0]);
    return pid + gain[2] * state[2];
  }
};

}  // namespace armwright::controllers
