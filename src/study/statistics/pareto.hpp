// Fronts of several objectives, all of which are minimised. A point is a vector of objectives; it
// dominates another point if it is nowhere larger and somewhere smaller. An objective may be
// +infinity (no value).
//
// All functions throw std::invalid_argument for points of different dimensions or of none, NaN and
// -infinity. No points at all are allowed: their front is empty, and their volume is 0.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace armwright {

// Returns the indices of the points that no other point dominates, in ascending order. All copies
// of such a point are kept.
std::vector<std::size_t> find_non_dominated(std::span<const std::vector<double>> points);

// Returns the volume that the points dominate, up to the reference point; larger is better. A point
// that is not smaller than the reference in every objective adds nothing. Source: Zitzler, E. and
// Thiele, L. 1998, Multiobjective optimization using evolutionary algorithms, PPSN V. The result is
// exact: a sweep for two objectives, n log n for n points; for m > 2, slices along the last
// objective, down to two (While, L., Hingston, P., Barone, L. and Huband, S. 2006, IEEE
// Transactions on Evolutionary Computation 10(1)), about n^(m-1). The reference must be finite.
double calc_hypervolume(std::span<const std::vector<double>> points,
                        std::span<const double> reference);

// Returns the inverted generational distance plus (IGD+), smaller is better: the mean over the points z of
// the front `reference` of the least distance of `points` from z, in which only objectives that are
// worse than those of z count: sqrt(sum_k max(p_k - z_k, 0)^2). Objectives count in units of `extent`, one
// positive number per objective. Points with an infinite objective do not count; without any point the
// result is infinite. If all points of one set are dominated by those of another, its value is never
// smaller. Source: Ishibuchi, H., Masuda, H., Tanigaki, Y. and Nojima, Y. 2015, Modified distance
// calculation in generational distance and inverted generational distance, EMO. The reference must be
// finite and have at least one point.
double calc_igd_plus(std::span<const std::vector<double>> points,
                     std::span<const std::vector<double>> reference,
                     std::span<const double> extent);

// Returns the empirical attainment surface of two objectives. `fronts` holds one set of points per
// run; dominated points are allowed. A run attains every point that one of its own points equals or
// surpasses in both objectives. The result is the corners, by increasing first objective, of the
// area that at least a share `level` of the runs attains: 0.5 gives the median front. It is empty
// if there is no such point. `level` is above 0 and at most 1. Source: Fonseca, C. M. and
// Fleming, P. J. 1996, On the performance assessment and comparison of stochastic multiobjective
// optimizers, PPSN IV.
std::vector<std::vector<double>> calc_attainment_surface(
    std::span<const std::vector<std::vector<double>>> fronts, double level);

}  // namespace armwright
