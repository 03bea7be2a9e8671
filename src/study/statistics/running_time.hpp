// How much it costs to reach a target: expected running time, and the distribution of running times
// over targets. Source: Hansen, N., Auger, A., Brockhoff, D., Tusar, D. and Tusar, T. 2016, COCO:
// performance assessment, arXiv:1605.03560. Costs are in evaluations, simulated cases or whatever
// the caller counts; a target that was not reached has the running time +infinity.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "study/statistics/bootstrap.hpp"

namespace armwright {

// The best value found so far, from this cost on. Traces have increasing costs.
struct TracePoint {
  double cost = 0;
  double best_value = 0;
};

// The cost at which the best value is finite and the target or below; infinite if never. Throws
// std::invalid_argument for NaN, values of -infinity, and costs that are negative or decrease.
double calc_cost_to_target(std::span<const TracePoint> trace, double target);

// One try to reach a target: its cost up to there if it was reached, all that it spent if not.
struct Trial {
  double cost = 0;
  bool reached = false;
};

// The functions on trials throw std::invalid_argument for no trials and costs that are negative or
// not finite.
//
// ERT = sum of all costs / number of trials that reached the target: what it would cost on average
// to start anew until it is reached. Infinite if it never was.
double calc_expected_running_time(std::span<const Trial> trials);

// `count` running times with simulated restarts: trials are drawn with replacement until one has
// reached the target, and their costs added. Their mean tends to ERT. All infinite if none has.
std::vector<double> simulate_running_times(std::span<const Trial> trials, int count,
                                           std::string_view stream);

// Bootstrapped interval of ERT: a resample is the mean of as many simulated running times as there
// are trials that reached the target. Both ends infinite if there is none.
Interval calc_expected_running_time_interval(std::span<const Trial> trials, double level,
                                             int resamples, std::string_view stream);

// Percentile bootstrap of ERT over trials: as many as there are, drawn with replacement. A resample
// in which no trial reached the target has an infinite ERT, so that the upper end, or both, may be
// infinite.
Interval calc_resampled_running_time_interval(std::span<const Trial> trials, double level,
                                              int resamples, std::string_view stream);

// ERT(trials) / ERT(reference), where the trials with the same number are a pair (one replicate)
// and are drawn together.
struct RunningTimeRatio {
  // Nothing if the reference never reached the target: by how much it was slower nobody knows.
  std::optional<double> ratio;
  // From 0 to infinity then. A resample in which neither reached it says nothing: it counts as 0
  // for the lower end and as infinite for the upper one.
  Interval interval;
};
// Throws std::invalid_argument, besides, unless there are as many trials as of the reference.
RunningTimeRatio calc_running_time_ratio(std::span<const Trial> trials,
                                         std::span<const Trial> reference, double level,
                                         int resamples, std::string_view stream);

// The share of running times, one a (trial, target) pair, that are no larger than each of `costs`.
// Throws std::invalid_argument for no running times and for negative ones.
std::vector<double> calc_runtime_ecdf(std::span<const double> running_times,
                                      std::span<const double> costs);

// The mean of that ECDF over costs from `lowest` to `highest`, all orders of magnitude weighing the
// same: its integral over log cost, divided by log(highest / lowest); computed exactly, as the mean
// over pairs of the share of that range which is left when the target is reached. From 0 (none
// reached before `highest`) to 1 (all by `lowest`): larger is better. Throws std::invalid_argument
// as calc_runtime_ecdf, and unless 0 < lowest < highest < infinity.
double calc_anytime_area(std::span<const double> running_times, double lowest, double highest);

}  // namespace armwright
