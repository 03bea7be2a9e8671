// The cascade of industrial drives: a P controller on the position gives a speed setpoint, and a PI
// controller on the speed gives the effort.
//   v_ref = kp e + share (r - r_prev) / h,   e_v = v_ref - (y - y_prev) / h,
//   u = kv e_v + ki sum(e_v) h,
// where r is the setpoint, y the measurement, e = r - y, and h the control period. Differences of
// angles take the short way round; differences in time are zero in the first step.
// With share = 1 it is a PID of P = kv kp + ki, I = ki kp and D = kv, except that its integral
// begins at another value. Converted from a PID it starts with kv = D, kp = P / D, ki = I D / P and
// share = 1: the same I and D, and a P that is larger by ki.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct Cascade {
  static constexpr const char* kName = "cascade";
  static constexpr const char* kSummary =
      "P on the position around PI on the speed, with a share of the target's speed ahead";
  static constexpr const char* kFormula =
      "u = kv e_v + ki sum(e_v) h, e_v = kp e + share (r - r_prev) / h - (y - y_prev) / h";
  static constexpr Gain kGains[] = {{"kp", "kp_per_s", "1/s"},
                                    {"kv", "kv_n_m_s_per_rad", "N m s/rad"},
                                    {"ki", "ki_n_m_per_rad", "N m/rad"},
                                    {"share", "share", "1", 1}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 3;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& pid, double* own) {
    own[0] = pid.p / pid.d;
    own[1] = pid.d;
    own[2] = pid.i * pid.d / pid.p;
    own[3] = 1;
  }

  template <class V>
  static void hold(V effort, Fields<V> gain, Fields<V> state) {
    state[0] = calc_integral(effort, gain[2]);
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    V& integral = state[0];
    const V target_speed = in.calc_rate(in.wrap_turns(update_change(in, in.setpoint, state[1])));
    const V speed = in.calc_rate(in.wrap_turns(update_change(in, in.measurement, state[2])));
    const V speed_error = gain[0] * in.error + gain[3] * target_speed - speed;
    integral = in.integrate(integral, speed_error);
    return gain[1] * speed_error + gain[2] * integral;
  }
};

}  // namespace armwright::controllers
