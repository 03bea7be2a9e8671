// How a tracking simulation's result comes to its end, said once for all engines.
#pragma once

#include <stdexcept>
#include <string>

#include "sim/tracking/tracking.hpp"

namespace armwright {

// An arm cannot be stepped any further: its engine gave up, or its state is not finite or far beyond any
// arm that is merely out of control.
class DivergenceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Whether the job's targets cannot be reached; then nothing is simulated, and the result says so.
bool apply_unreachable(const TrackingJob& job, TrackingResult& result);
// The error of the point that is being measured exceeds the job's cut-off: that point and the rest
// count as the cut-off error.
void apply_cutoff(const TrackingTask& task, const TrackingJob& job, TrackingResult& result);
// The step after those counted in the result went wrong; under a cut-off the rest of the points
// counts as its error.
void apply_divergence(const TrackingTask& task, const TrackingJob& job, const std::string& what,
                      TrackingResult& result);
// To be asked after every point: whether the case's error is certain to exceed the job's bound
// already; then the result says so.
bool apply_abandonment(const TrackingTask& task, const TrackingJob& job, TrackingResult& result);
// Makes root-mean-squares and shares of the sums that rms_effort_n_m (of squares) and
// saturated_share (of steps) have gathered, and the case's error of the points'.
void complete_result(const TrackingTask& task, const TrackingJob& job, TrackingResult& result);

}  // namespace armwright
