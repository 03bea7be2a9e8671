// What the controllers have in common that add a share of efforts known in advance to a PID:
//   u = PID + share f,
// f the effort of the step. They differ in what f is (kFeedForward), and start with share = 1.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct PidFeedForward {
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"},
                                    {"share", "share", "1", 1}};
  static constexpr int kStates = 2;

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
