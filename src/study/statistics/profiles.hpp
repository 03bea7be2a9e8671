// Data and performance profiles for a limited budget. Source: Moré, J. J. and Wild, S. M. 2009,
// Benchmarking derivative-free optimization algorithms, SIAM Journal on Optimization 20(1),
// 172-191, equations 2.1 to 2.3; performance profiles after Dolan, E. D. and Moré, J. J. 2002,
// Mathematical Programming 91(2). A solver has converged on a problem when
//
//   f <= fL + tau (f0 - fL)
//
// where f0 is the value at the start, the same for all, and fL the smallest that any solver found.
// The cost of that, from its trace, is calc_cost_to_target's.
#pragma once

#include <span>
#include <vector>

namespace armwright {

// The right side above; tau from 0 to 1. The start counts among what was found: fL > f0 is taken
// for f0, and with fL = f0 every solver that has evaluated the start, or a point as good, has
// converged. If the start has no value (f0 infinite), any finite value converges: there is no
// finite share of an infinite way (the target is the largest finite number). Throws
// std::invalid_argument for NaN, -infinity and other tau.
double calc_convergence_target(double start_value, double best_value, double tau);

// costs[p][s]: what it cost solver s to converge on problem p, +infinity if it did not; then it
// counts as not solved at any abscissa, and a problem that nobody solved is one for all. Both
// return shares[s][i]: the share of problems that solver s has solved at the i-th abscissa. Both
// throw std::invalid_argument for an empty or ragged table and for negative costs.
//
// Performance profile, rho_s(alpha): solved at a cost of at most alpha times the smallest on that
// problem. All with the smallest have the ratio 1; beside a smallest cost of 0, others have no
// finite ratio.
std::vector<std::vector<double>> calc_performance_profiles(
    std::span<const std::vector<double>> costs, std::span<const double> alphas);

// Data profile, d_s(kappa): solved within kappa (n_p + 1) evaluations, n_p = dimensions[p]: as many
// as kappa simplex gradients take. Throws for as many dimensions as there are not problems, too.
std::vector<std::vector<double>> calc_data_profiles(std::span<const std::vector<double>> costs,
                                                    std::span<const int> dimensions,
                                                    std::span<const double> kappas);

}  // namespace armwright
