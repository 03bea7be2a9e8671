// A PID, and the efforts that move the arm along its target:
//   u = PID + share (M(q_d) a_d + C(q_d, v_d) + g(q_d)),
// of the arm that the problem says (articulated/feed_forward.hpp has the discrete form). It starts
// with share = 1. Luh, Walker and Paul 1980 feed the measured state into the same equations; here
// they depend on the target alone, as drives with a table have it.
#pragma once

#include "sim/controllers/pid_feed_forward.hpp"

namespace armwright::controllers {

struct PidComputedTorque : PidFeedForward {
  static constexpr const char* kName = "pid_computed_torque";
  static constexpr const char* kSummary =
      "PID and the efforts that move the arm along its target, by inverse dynamics";
  static constexpr const char* kFormula =
      "u = p e + i sum(e) h + d (e - e_prev) / h + share (M(q_d) a_d + C(q_d, v_d) + g(q_d))";
  static constexpr FeedForward kFeedForward = FeedForward::inverse_dynamics;
};

}  // namespace armwright::controllers
