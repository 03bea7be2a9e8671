// The five reference signals over one move, with the exact derivatives of their formulas
// (sim/reference_signal.hpp), and how short moves are slowed down: the thesis's Fig. 5.5-5.8 and
// 5.10. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/tracking/task.hpp"

namespace armwright {

struct SignalSample {
  double time_s = 0;
  double distance_m = 0;
  double speed_m_per_s = 0;
  double acceleration_m_per_s2 = 0;
};

// From rest at time 0 to the end of the rest after the move. Where a quantity jumps there are two
// samples of the same time, before and after. Speed and acceleration of the step, which would be
// infinite for an instant, are 0.
std::vector<SignalSample> sample_signal(SignalShape shape, double distance_m, double speed_m_per_s,
                                        double acceleration_m_per_s2, double rest_s);

// A move that is not slowed down: as long as the distance limit, or 0.9 m where there is none.
double choose_signal_distance(const TrackingTask& task);

// Signals: of that move, at the task's speed. `used` is the name to show for the signal in use.
nlohmann::json make_signals(const TrackingTask& task, bool name_used);

// "complex" as the page names it: "Complex".
std::string make_signal_title(SignalShape shape);

}  // namespace armwright
