// Quantiles by linear interpolation between order statistics: type 7 of Hyndman, R. J. and Fan, Y.
// 1996, Sample quantiles in statistical packages, The American Statistician 50(4). With the n
// values sorted from x_0, the p-quantile lies at h = p (n - 1), between x_floor(h) and the next.
// An infinite neighbour makes it infinite unless h falls on a finite one: the median of 1, 2, inf,
// inf is inf.
#pragma once

#include <span>

namespace armwright {

// p from 0 to 1. Throws std::invalid_argument for other p, no values, NaN and -infinity.
double calc_quantile(std::span<const double> values, double p);

struct Spread {
  double median = 0;
  double lower_quartile = 0;
  double upper_quartile = 0;
};

Spread calc_spread(std::span<const double> values);

}  // namespace armwright
