// The cost of reaching a target: expected running time, the distribution of running times over
// targets (Hansen, N., Auger, A., Brockhoff, D., Tusar, D. and Tusar, T. 2016, COCO: performance
// assessment, arXiv:1605.03560), and data and performance profiles. Costs are in evaluations,
// simulated cases or another unit of the caller. The running time of a target that was not reached
// is +infinity.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "study/statistics/summary.hpp"

namespace armwright {

// The best value that was found for at most this cost. A trace has increasing costs.
struct TracePoint {
  double cost = 0;
  double best_value = 0;
};

// Returns the cost at which the best value is first finite and at most the target; infinity if
// never. Throws std::invalid_argument for NaN, values of -infinity, and costs that are negative or
// decrease.
double calc_cost_to_target(std::span<const TracePoint> trace, double target);

// One attempt to reach a target.
struct Trial {
  double cost = 0;  // until the target was reached; the whole cost if it was not
  bool reached = false;
};

// The functions on trials throw std::invalid_argument for no trials and for costs that are negative
// or not finite.
//
// Returns ERT = sum of all costs / number of trials that reached the target: the expected cost if
// the optimizer is restarted until it reaches the target. Infinity if no trial reached it.
double calc_expected_running_time(std::span<const Trial> trials);

// Returns the percentile bootstrap interval of ERT over trials: each resample has as many trials as
// there are, drawn with replacement. A resample in which no trial reached the target has an
// infinite ERT, so one or both ends may be infinite.
Interval calc_resampled_running_time_interval(std::span<const Trial> trials, double level,
                                              int resamples, std::string_view stream);

struct RunningTimeRatio {
  // Nothing if the reference never reached the target: the ratio is then not known.
  std::optional<double> ratio;
  // From 0 to infinity if there is no ratio. A resample in which neither reached the target counts
  // as 0 for the lower end and as infinite for the upper end.
  Interval interval;
};
// Returns ERT(trials) / ERT(reference). Trials with the same number are a pair (one replicate) and
// are drawn together. Also throws std::invalid_argument for different numbers of trials.
RunningTimeRatio calc_running_time_ratio(std::span<const Trial> trials,
                                         std::span<const Trial> reference, double level,
                                         int resamples, std::string_view stream);

// Returns for each of `costs` the share of running times that are at most this cost; there is one
// running time per pair of trial and target. Throws std::invalid_argument for no running times and
// for negative ones.
std::vector<double> calc_runtime_ecdf(std::span<const double> running_times,
                                      std::span<const double> costs);

// Returns the mean of that ECDF over the logarithm of the cost, from `lowest` to `highest`: its
// integral over log cost, divided by log(highest / lowest). It is computed exactly, as the mean
// over the running times of the share of that range that is left after the target is reached. 0 if
// no target is reached before `highest`, 1 if all are reached by `lowest`; larger is better. Throws
// std::invalid_argument as calc_runtime_ecdf(), and unless 0 < lowest < highest < infinity.
double calc_anytime_area(std::span<const double> running_times, double lowest, double highest);

// Data and performance profiles for a limited budget. Source: Moré, J. J. and Wild, S. M. 2009,
// Benchmarking derivative-free optimization algorithms, SIAM Journal on Optimization 20(1),
// 172-191, equations 2.1 to 2.3; performance profiles as in Dolan, E. D. and Moré, J. J. 2002,
// Mathematical Programming 91(2). A solver has converged on a problem when
//
//   f <= fL + tau (f0 - fL)
//
// where f0 is the value at the start, the same for all solvers, and fL the smallest value that any
// solver found. calc_cost_to_target() gives the cost from a solver's trace.

// Returns the right side of that inequality; tau is from 0 to 1. The start counts as found, so f0
// replaces an fL > f0; with fL = f0 every solver has converged that has evaluated the start or a
// point as good. If f0 is infinite, the target is the largest finite number: any finite value
// converges, because no share of an infinite distance is finite. Throws std::invalid_argument for
// NaN, -infinity and other tau.
double calc_convergence_target(double start_value, double best_value, double tau);

// The profiles take costs[p][s], the cost at which solver s converged on problem p, +infinity if it
// did not; it then counts as not solved at any abscissa. Problems that no solver solved count, too.
// They return shares[s][i], the share of problems that solver s has solved at the i-th abscissa.
// They throw std::invalid_argument for an empty table, rows of different lengths and negative
// costs.
//
// Performance profile rho_s(alpha): the share solved at a cost of at most alpha times the smallest
// cost on that problem. Every solver with the smallest cost has the ratio 1; if that cost is 0, the
// others have no finite ratio.
std::vector<std::vector<double>> calc_performance_profiles(
    std::span<const std::vector<double>> costs, std::span<const double> alphas);

// Data profile d_s(kappa): the share solved within kappa (n_p + 1) evaluations, the cost of kappa
// simplex gradients, where n_p = dimensions[p]. Also throws for another number of dimensions than
// problems.
std::vector<std::vector<double>> calc_data_profiles(std::span<const std::vector<double>> costs,
                                                    std::span<const int> dimensions,
                                                    std::span<const double> kappas);

}  // namespace armwright
