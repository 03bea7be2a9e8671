// A PID, and the efforts that move the arm along its target:
//   u = PID + share (M(q_d) a_d + C(q_d, v_d) + g(q_d)),
// of the arm that the problem says (articulated/feed_forward.hpp has the discrete form). It starts
// with share = 1. Luh, Walker and Paul 1980 feed the measured state into the same equations; here
// they depend on the target alone, as drives with a table have it.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct PidComputedTorque {
  static constexpr const char* kName = "pid_computed_torque";
  static constexpr const char* kSummary =
      "PID and the efforts that move the arm along its target, by inverse dynamics";
  static constexpr const char* kFormula =
      "u = p e + i sum(e) h + d (e - e_prev) / h + share (M(q_d) a_d + C(q_d, v_d) + g(q_d))";
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"},
                                    {"share", "share", "1", 1}};
  static constexpr int kStates = 2;
  static constexpr FeedForward kFeedForward = FeedForward::inverse_dynamics;

  static void convert(const PidStart& pid, double* own) {
    own[0] = pid.p;
    own[1] = pid.i;
    own[2] = pid.d;
    own[3] = 1;
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    return calc_pid(in, gain[0], gain[1], gain[2], state) + gain[3] * in.feed_forward;
  }
};

}  // namespace armwright::controllers
