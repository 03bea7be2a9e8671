// A PID, and the efforts that hold the arm where its target is:
//   u = PID + share g(q_target),
// g of the arm that the problem says, in the posture of the target at the start of the period.
#pragma once

#include "sim/controllers/pid_feed_forward.hpp"

namespace armwright::controllers {

struct PidGravity : PidFeedForward {
  static constexpr const char* kName = "pid_gravity";
  static constexpr const char* kSummary =
      "PID and the efforts that hold the arm against gravity where its target is";
  static constexpr const char* kFormula =
      "u = p e + i sum(e) h + d (e - e_prev) / h + share g(q_target)";
  static constexpr FeedForward kFeedForward = FeedForward::gravity;
};

}  // namespace armwright::controllers
