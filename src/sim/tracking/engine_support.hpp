// Functions that every engine uses, so that all engines check a job and end a result alike.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "sim/tracking/simulation.hpp"

namespace armwright {

// Thrown when an arm cannot be stepped any further: its engine stopped, or its state is not finite
// or far beyond that of any arm that is only out of control.
class DivergenceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// An engine that knows the links' places ends at these; no arm that is only out of control comes
// near them.
inline constexpr double kFarthestLink_m = 1e3;
inline constexpr double kFastestLink_rad_per_s = 1e6;

// What the reason of a divergence says of a joint whose state is not finite.
inline constexpr std::string_view kNotFinite = "its position or speed is not a finite number";

// Throws Error{usage} if the job's controller commands something else than the task's drives take,
// or if it needs feed-forward efforts and the target table of a case that can be simulated has none.
void check_controller(const TrackingTask& task, const TrackingJob& job);

// Returns whether the job's targets are out of reach. If so, the result gets the status
// `unreachable`, and the engine must not simulate the job.
bool apply_unreachable(const TrackingJob& job, TrackingResult& result);
// Ends a result whose present point exceeds the job's cut-off. That point and all later ones get
// the cut-off error.
void apply_cutoff(const TrackingTask& task, const TrackingJob& job, TrackingResult& result);
// Ends a result whose next step failed; `what` says how. In training the points that were not
// reached get the cut-off error.
void apply_divergence(const TrackingTask& task, const TrackingJob& job, const std::string& what,
                      TrackingResult& result);
// Returns whether the case's error is certain to exceed the job's bound. If so, the result gets the
// status `abandoned`. Engines call it after every point.
bool apply_abandonment(const TrackingTask& task, const TrackingJob& job, TrackingResult& result);
// Completes a result: replaces the sums that were gathered in rms_effort (squares) and
// saturated_share (steps) by root mean squares and shares, and computes the case's error.
void complete_result(const TrackingTask& task, const TrackingJob& job, TrackingResult& result);

}  // namespace armwright
