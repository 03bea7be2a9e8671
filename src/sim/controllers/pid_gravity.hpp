// A PID, and the efforts that hold the arm where its target is:
//   u = PID + share g(q_target),
// g of the arm that the problem says, in the posture of the target at the start of the period. It
// starts with share = 1.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct PidGravity {
  static constexpr const char* kName = "pid_gravity";
  static constexpr const char* kSummary =
      "PID and the efforts that hold the arm against gravity where its target is";
  static constexpr const char* kFormula =
      "u = p e + i sum(e) h + d (e - e_prev) / h + share g(q_target)";
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"},
                                    {"share", "share", "1", 1}};
  static constexpr int kStates = 2;
  static constexpr FeedForward kFeedForward = FeedForward::gravity;

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
