// What a control law says of itself besides its formula, in plain types: laws are compiled for
// every instruction set (lane_pack.hpp) and must not bring the standard library along.
#pragma once

#include <cstdint>

namespace armwright {

// Efforts that are known before anything moves, tabulated once a test case for the arm that the
// problem says (articulated/feed_forward.hpp).
enum class FeedForward : std::uint8_t { none, gravity, inverse_dynamics };

namespace controllers {

struct Gain {
  const char* name;
  const char* key;  // with its unit, as in design files
  const char* unit;
  // As a decision variable: 0, a factor around its start, on a logarithmic scale; otherwise linear,
  // this far to either side, but never below 0 unless it may have any sign.
  double range = 0;
  bool any_sign = false;
};

// A joint's PID, of which a law makes its own first gains.
struct PidStart {
  double p, i, d;
  double effort_limit;  // the larger of both limits, max(-min, max)
  double period_s;
};

}  // namespace controllers
}  // namespace armwright
