// Samples the five reference signals over one move, with the exact derivatives of their formulas
// (sim/tracking/reference_signal.hpp), and the lower speed of short moves: the thesis's Fig.
// 5.5-5.8 and 5.10.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sim/tracking/task.hpp"

namespace armwright {

// The target at one time, measured along the move.
struct SignalSample {
  double time_s = 0;
  double distance_m = 0;
  double speed_m_per_s = 0;
  double acceleration_m_per_s2 = 0;
};

// Returns samples from the rest at time 0 to the end of the rest after the move. Where a quantity
// jumps there are two samples of the same time, one before and one after the jump. For the step,
// speed and acceleration are infinite for an instant; the samples have 0.
std::vector<SignalSample> sample_signal(SignalShape shape, double distance_m, double speed_m_per_s,
                                        double acceleration_m_per_s2, double rest_s);

// Returns the length of a move that is not slowed down: the distance limit, or 0.9 m if the task
// has none.
double choose_signal_distance(const TrackingTask& task);

// Returns Signals of web/src/data.ts for this move at the task's speed. With `name_used`, the page
// shows which signal the task uses.
nlohmann::json make_signals(const TrackingTask& task, bool name_used);

// Returns the signal's name for the page, such as "Complex".
std::string make_signal_title(SignalShape shape);

}  // namespace armwright
