// The reference signal of a move: the distance s(t) that the target has covered after t seconds
// (thesis section 5.2.3). With v the average speed, every shape reaches the distance ds at
// t_m = ds / v and stays there.
//   step        s = ds
//   ramp        s = v t
//   trapezoid   constant acceleration a, plateau, deceleration; triangular where a is too small
//   triangular  accelerates half of the time, decelerates the other half
//   complex     speed rises linearly to 2.5 v at 0.4 t_m, then decays quadratically:
//               s = 25 v^2 t^2 / (8 ds) before, s = ds - 125 (ds - v t)^3 / (54 ds^2) after
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/kinematics/targets.hpp"

namespace armwright {

const std::vector<std::string>& signal_names();  // in the order of the enum
// Returns the shape of that name. Throws Error{usage} if there is none.
SignalShape find_signal(const std::string& name);

// Returns the signal of a move of one distance at one speed; targets::calc_distance() computes its
// s(t). Throws Error{usage} unless distance, speed and duration are finite and > 0, and for a
// trapezoid also the acceleration. The other shapes do not use the acceleration.
targets::SignalCurve make_signal_curve(SignalShape shape, double distance_m, double speed_m_per_s,
                                       double acceleration_m_per_s2);

}  // namespace armwright
