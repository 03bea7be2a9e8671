// Percentile bootstrap: values are drawn with replacement, as many as there are, and the statistic
// computed, again and again; the interval leaves out (1 - level) / 2 of the results at each end
// (quantiles of type 7). Source: Efron, B. and Tibshirani, R. J. 1993, An Introduction to the
// Bootstrap, section 13.3. From few values it is too short: the interval of one is that value.
#pragma once

#include <functional>
#include <span>
#include <string_view>

namespace armwright {

struct Interval {
  double lower = 0;
  double upper = 0;
};

// Takes values in any order; returns no NaN.
using Statistic = std::function<double(std::span<const double>)>;

// The draws are those of RandomStream(stream): the same name, the same interval. Throws
// std::invalid_argument for no values, NaN and -infinity, a level outside (0, 1) and no resamples.
Interval calc_bootstrap_interval(std::span<const double> values, const Statistic& statistic,
                                 double level, int resamples, std::string_view stream);

Interval calc_median_interval(std::span<const double> values, double level, int resamples,
                              std::string_view stream);

// What lies between the quantiles (1 - level) / 2 and (1 + level) / 2 of what was resampled.
Interval calc_percentile_interval(std::span<const double> resampled, double level);

}  // namespace armwright
