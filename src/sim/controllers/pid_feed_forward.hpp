// PIDs that add a share of efforts that are known in advance:
//   u = PID + share f,
// f being the effort of the step. They start with share = 1 and differ in f (kFeedForward), which
// is computed for the nominal arm of the problem (sim/tracking/feed_forward.cpp has the discrete
// form).
//   pid_gravity          f = g(q_target), which holds the arm in the posture that the target has at
//                        the start of the period
//   pid_computed_torque  f = M(q_d) a_d + C(q_d, v_d) + g(q_d), which moves it along the target
// Luh, Walker and Paul 1980 put the measured state into the same equations. Here they depend on the
// target alone, as in drives with a table.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct PidFeedForward {
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"},
                                    {"share", "share", "1", 1}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 2;

  static void convert(const PidStart& pid, double* own) {
    own[0] = pid.p;
    own[1] = pid.i;
    own[2] = pid.d;
    own[3] = 1;
  }

  // The integral holds what the share leaves.
  template <class V>
  static void hold(V effort, Fields<V> gain, Fields<V> state) {
    state[0] = calc_integral((V(1) - gain[3]) * effort, gain[1]);
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    return calc_pid(in, gain[0], gain[1], gain[2], state) + gain[3] * in.feed_forward;
  }
};

struct PidGravity : PidFeedForward {
  static constexpr const char* kName = "pid_gravity";
  static constexpr const char* kSummary =
      "PID and the efforts that hold the arm against gravity where its target is";
  static constexpr const char* kFormula =
      "u = p e + i sum(e) h + d (e - e_prev) / h + share g(q_target)";
  static constexpr FeedForward kFeedForward = FeedForward::gravity;
};

struct PidComputedTorque : PidFeedForward {
  static constexpr const char* kName = "pid_computed_torque";
  static constexpr const char* kSummary =
      "PID and the efforts that move the arm along its target, by inverse dynamics";
  static constexpr const char* kFormula =
      "u = p e + i sum(e) h + d (e - e_prev) / h + share (M(q_d) a_d + C(q_d, v_d) + g(q_d))";
  static constexpr FeedForward kFeedForward = FeedForward::inverse_dynamics;
};

}  // namespace armwright::controllers
