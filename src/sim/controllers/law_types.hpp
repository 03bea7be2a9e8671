// Facts about a control law besides its formula, in plain types. Laws are compiled for every
// instruction set (lane_pack.hpp), so they must not include the standard library.
#pragma once

#include <cstdint>

namespace armwright {

// Efforts that are known before a simulation starts. They are tabulated once per test case, for the
// nominal arm of the problem (sim/tracking/feed_forward.cpp).
enum class FeedForward : std::uint8_t { none, gravity, inverse_dynamics };

// The quantity that a controller commands: the effort of the motor, or the speed or position of a drive that has
// an inner loop (sim/tracking/arm_drives.hpp).
enum class ControlInterface : std::uint8_t { effort, velocity, position };

namespace controllers {

struct Gain {
  const char* name;  // "p"
  const char* key;   // with its unit, as in design files: "p_n_m_per_rad"
  const char* unit;  // "N m/rad"
  // Bounds as a decision variable. 0: a factor around its start, on a logarithmic scale. Otherwise
  // linear, this far to either side of the start, but not below 0 unless it may have any sign.
  double range = 0;
  bool any_sign = false;
};

// A joint's PID, from which a law computes the start values of its own gains. Laws that command
// drives use the times alone.
struct PidStart {
  double p, i, d;
  double effort_limit;  // the larger of both limits, max(-min, max)
  double period_s;
  double lag_s = 0;  // how long a drive takes to follow a command (ArmDrives::calc_lag_s())
};

}  // namespace controllers
}  // namespace armwright
