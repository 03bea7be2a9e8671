// Summaries of values: quantiles, bootstrap intervals, and the errors of a set of test cases. All
// functions but the last two throw std::invalid_argument for no values, NaN and -infinity.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace armwright {

// Returns the p-quantile by linear interpolation between order statistics: type 7 of Hyndman, R. J.
// and Fan, Y. 1996, Sample quantiles in statistical packages, The American Statistician 50(4). In
// the n sorted values x_0, ..., it lies at h = p (n - 1), between x_floor(h) and the next. If one
// of these two is infinite the quantile is infinite, unless h is a whole number: the median of 1,
// 2, inf, inf is inf. p is from 0 to 1; throws std::invalid_argument for others.
double calc_quantile(std::span<const double> values, double p);

struct Spread {
  double median = 0;
  double lower_quartile = 0;
  double upper_quartile = 0;
};

Spread calc_spread(std::span<const double> values);

struct Interval {
  double lower = 0;
  double upper = 0;
};

// Computes a number from values in any order. It must not return NaN.
using Statistic = std::function<double(std::span<const double>)>;

// Returns the percentile bootstrap interval of a statistic. Each resample has as many values as
// there are, drawn with replacement; the interval leaves out (1 - level) / 2 of the resampled
// statistics at each end (calc_percentile_interval). Source: Efron, B. and Tibshirani, R. J. 1993,
// An Introduction to the Bootstrap, section 13.3. Limit: of few values the interval is too short;
// of one value it has length 0. The draws come from RandomStream(stream), so the same name gives
// the same interval. Also throws std::invalid_argument for a level outside (0, 1) or no resamples.
Interval calc_bootstrap_interval(std::span<const double> values, const Statistic& statistic,
                                 double level, int resamples, std::string_view stream);

// Returns the bootstrap interval of the median.
Interval calc_median_interval(std::span<const double> values, double level, int resamples,
                              std::string_view stream);

// Returns the quantiles (1 - level) / 2 and (1 + level) / 2 of resampled statistics.
Interval calc_percentile_interval(std::span<const double> resampled, double level);

// Both count only the values that are not NaN, n of them.
struct MeanAndError {
  double mean;            // NaN for n = 0
  double standard_error;  // s / sqrt(n), with s the standard deviation; NaN for n < 2
};

MeanAndError calc_mean_and_error(std::span<const double> values);

// The errors of a set of test cases. A mean alone would be decided by a few arms that lose their
// target.
struct ErrorSummary {
  std::uint64_t cases = 0;
  std::uint64_t without_number = 0;  // diverged or unreachable; they count as failures
  std::uint64_t failures = 0;        // error above the threshold, or without number
  std::optional<double> mean;        // over the cases with a number; nothing if there is none
  std::optional<double> median;      // a case without number counts as larger than all others
  std::optional<double> percentile_95;
  std::optional<double> worst;  // nothing if any case is without number
};

// Summarizes one error per case, NaN for a case without number. A case fails if its error exceeds
// `failure_error`: kFailureError_m for an arm, infinity for a function.
ErrorSummary summarize(std::span<const double> errors, double failure_error);

}  // namespace armwright
