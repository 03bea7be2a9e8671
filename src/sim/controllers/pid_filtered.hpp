// A PID with a filtered derivative and setpoint weights (Astrom and Hagglund 2006, Advanced PID
// Control, sections 3.3 and 3.4):
//   u = P (e - (1 - b) w) + I sum(e) h + D f,
//   f_k = (T f_(k-1) + (e_k - e_(k-1)) - (1 - c) (r_k - r_(k-1))) / (T + h),
// by backward differences. T is the filter's time constant; b and c weigh how P and D see the
// setpoint r. w = r - r_1 is the way of the setpoint since the first step, summed from differences
// taken the short way round. The source weighs r itself and lets the integral begin in balance,
// which is equivalent. With b = c = 1 and T = 0 it is the PID. It starts with b = c = 1 and
// T = h / 10.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct PidFiltered {
  static constexpr const char* kName = "pid_filtered";
  static constexpr const char* kSummary =
      "PID with a first-order filter on the derivative and weights of the setpoint in P and D";
  static constexpr const char* kFormula =
      "u = p (e - (1 - b) w) + i sum(e) h + d f, "
      "f = (filter f_prev + e - e_prev - (1 - c) (r - r_prev)) / (filter + h), w = r - r_first";
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"},
                                    {"filter", "filter_s", "s"},
                                    {"b", "b", "1", 1},
                                    {"c", "c", "1", 1}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 5;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& pid, double* own) {
    constexpr double kFirstShare = 0.1;
    own[0] = pid.p;
    own[1] = pid.i;
    own[2] = pid.d;
    own[3] = kFirstShare * pid.period_s;
    own[4] = 1;
    own[5] = 1;
  }

  template <class V>
  static void hold(V effort, Fields<V> gain, Fields<V> state) {
    state[0] = calc_integral(effort, gain[1]);
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    V& integral = state[0];
    V& way = state[3];
    V& rate = state[4];
    integral = in.integrate(integral, in.error);
    const V change = update_change(in, in.error, state[1]);
    const V moved = in.wrap_turns(update_change(in, in.setpoint, state[2]));
    way += moved;
    const V filter_s = gain[3];
    const V one = V(1);
    rate = (filter_s * rate + (change - (one - gain[5]) * moved)) / (filter_s + in.period_s);
    return gain[0] * (in.error - (one - gain[4]) * way) + gain[1] * integral + gain[2] * rate;
  }
};

}  // namespace armwright::controllers
