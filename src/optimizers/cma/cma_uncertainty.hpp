// How far the ranks of a generation change when some of its points are evaluated again: the measure
// s of Hansen, Niederberger, Guzzella and Koumoutsakos 2009, A method for handling uncertainty in
// evolutionary optimization with an application to feedback control of combustion, section III
// (UH-CMA-ES). s > 0: the noise decides more of the ranking than it may, and sigma shall grow. With
// both values in one set of 2 lambda,
//
//   Delta_i = rank(new_i) - rank(old_i) - sign(rank(new_i) - rank(old_i))
//   s = mean over the points evaluated again of
//       2 |Delta_i| - lim(rank(new_i) - [new_i > old_i]) - lim(rank(old_i) - [old_i > new_i])
//
// lim(R) is the (theta / 2)-quantile of {|1 - R|, |2 - R|, ..., |2 lambda - 1 - R|}, theta = 0.2.
// Deviation: the points are evaluated again where they are, without the paper's tiny mutation,
// which only serves functions that remember their arguments.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace armwright {

struct UncertaintyMeasure {
  double s = 0;
  std::vector<std::size_t> ranking;  // by the sum of both ranks, the best first
};

// `again` holds the new values of the first points; it may be empty.
UncertaintyMeasure measure_uncertainty(std::span<const double> values,
                                       std::span<const double> again);

}  // namespace armwright
