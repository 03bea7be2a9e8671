// Fronts of several objectives, all minimised. A point is a vector of objectives; it dominates
// another if it is nowhere larger and somewhere smaller. An objective may be +infinity (no value).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace armwright {

// All functions throw std::invalid_argument for points of different dimensions or of none, NaN and
// -infinity. No points are allowed: they have no front, no volume, and attain nothing.

// Which points no other one dominates, in their order; copies of such a point are all kept.
std::vector<std::size_t> find_non_dominated(std::span<const std::vector<double>> points);

// The volume that the points dominate, up to the reference point; larger is better. A point that is
// not smaller than it in every objective adds nothing. Source: Zitzler, E. and Thiele, L. 1998,
// Multiobjective optimization using evolutionary algorithms, PPSN V. Exact: a sweep for two
// objectives, n log n for n points; for m > 2, slices along the last objective, down to two (While,
// L., Hingston, P., Barone, L. and Huband, S. 2006, IEEE Transactions on Evolutionary Computation
// 10(1)), about n^(m-1). The reference must be finite.
double calc_hypervolume(std::span<const std::vector<double>> points,
                        std::span<const double> reference);

// Empirical attainment of two objectives. `fronts` holds one set of points a run, dominated ones
// allowed. Returns the corners, by increasing first objective, of the area whose every point is
// attained (reached or surpassed in both objectives by some point) by at least a share `level` of
// the runs: 0.5 is the median front. Empty if no point is. Level above 0, up to 1. Source: Fonseca,
// C. M. and Fleming, P. J. 1996, On the performance assessment and comparison of stochastic
// multiobjective optimizers, PPSN IV.
std::vector<std::vector<double>> calc_attainment_surface(
    std::span<const std::vector<std::vector<double>>> fronts, double level);

}  // namespace armwright
