// The measure s of how far the ranks of a generation change when some of its points are evaluated
// again. Source: Hansen, Niederberger, Guzzella and Koumoutsakos 2009, A method for handling
// uncertainty in evolutionary optimization with an application to feedback control of combustion,
// section III (UH-CMA-ES). s > 0 means that noise decides too much of the ranking, and sigma should
// grow. With both values of a point in one set of 2 lambda values,
//
//   Delta_i = rank(new_i) - rank(old_i) - sign(rank(new_i) - rank(old_i))
//   s       = mean over the points that are evaluated again of
//             2 |Delta_i| - lim(rank(new_i) - [new_i > old_i]) - lim(rank(old_i) - [old_i > new_i])
//
// lim(R) is the (theta / 2)-quantile of {|1 - R|, |2 - R|, ..., |2 lambda - 1 - R|}, theta = 0.2.
// Deviation: the points are evaluated again without the small mutation of the paper, which helps
// only functions that remember their arguments.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace armwright {

struct UncertaintyMeasure {
  double s = 0;
  std::vector<std::size_t> ranking;  // indices by the sum of both ranks, the best first
};

// Measures the uncertainty. `again` holds the new values of the first points; it may be empty.
UncertaintyMeasure measure_uncertainty(std::span<const double> values,
                                       std::span<const double> again);

}  // namespace armwright
