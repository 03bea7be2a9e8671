// A discrete PID with clamped output (thesis section 5.2.2):
//   u = P e + I sum(e) h + D (e - e_prev) / h,   e = setpoint - measurement.
// The derivative of the first step is zero.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct Pid {
  static constexpr const char* kName = "pid";
  static constexpr const char* kSummary =
      "discrete PID with clamped effort; does not integrate after a clamped step";
  static constexpr const char* kFormula = "u = p e + i sum(e) h + d (e - e_prev) / h";
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 2;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& pid, double* own) {
    own[0] = pid.p;
    own[1] = pid.i;
    own[2] = pid.d;
  }

  template <class V>
  static void hold(V effort, Fields<V> gain, Fields<V> state) {
    state[0] = calc_integral(effort, gain[1]);
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    return calc_pid(in, gain[0], gain[1], gain[2], state);
  }
};

}  // namespace armwright::controllers
