// Friedman's test: do k treatments differ, ranked within each of n blocks? Source: Friedman, M.
// 1937, The use of ranks to avoid the assumption of normality implicit in the analysis of variance,
// JASA 32(200); the correction for ties as in Conover, W. J. 1999, Practical Nonparametric
// Statistics, section 5.8:
//
//   chi^2 = 12 sum_j (R_j - n(k+1)/2)^2 / (n k (k+1) - T / (k-1)),  k - 1 degrees of freedom
//
// with R_j the sum of the ranks of treatment j, and T the sum of t^3 - t over ties of t within
// blocks. Its chi^2 approximation is conservative; better is (Iman, R. L. and Davenport, J. M.
// 1980, Approximations of the critical region of the Friedman statistic, Communications in
// Statistics A 9(6))
//
//   F = (n-1) chi^2 / (n (k-1) - chi^2),  k - 1 and (k-1)(n-1) degrees of freedom.
//
// If every block is tied all through, chi^2 and F are 0 and both p are 1. If all blocks agree
// completely (the same ranks in each), F is infinite and its p is 0: read chi^2's p then.
#pragma once

#include <span>
#include <vector>

namespace armwright {

struct FriedmanTest {
  std::vector<double> mean_ranks;  // of the treatments; 1 is best
  double chi_squared = 0;
  double degrees = 0;
  double p_value = 1;
  double f = 0;  // Iman and Davenport's
  double f_degrees_1 = 0;
  double f_degrees_2 = 0;
  double f_p_value = 1;
};

// blocks[i][j]: treatment j in block i. Throws std::invalid_argument for fewer than 2 blocks or
// treatments, blocks of unequal lengths, NaN and -infinity.
FriedmanTest calc_friedman_test(std::span<const std::vector<double>> blocks);

}  // namespace armwright
