// Tests of significance and effect sizes. Smaller values are better, and +infinity is a cell
// without a result. All functions throw std::invalid_argument for NaN and -infinity.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace armwright {

// A difference is significant if its p-value, adjusted for the number of tests, is below this.
inline constexpr double kSignificance = 0.05;
// With fewer pairs no outcome is significant: 2 / 2^5 > 0.05.
inline constexpr int kFewestPairs = 6;

// The result of Friedman's test: do k treatments differ, if they are ranked within each of n
// blocks? Source: Friedman, M. 1937, The use of ranks to avoid the assumption of normality implicit
// in the analysis of variance, JASA 32(200); the correction for ties as in Conover, W. J. 1999,
// Practical Nonparametric Statistics, section 5.8:
//
//   chi^2 = 12 sum_j (R_j - n(k+1)/2)^2 / (n k (k+1) - T / (k-1)),  k - 1 degrees of freedom
//
// where R_j is the sum of the ranks of treatment j, and T is the sum of t^3 - t over the groups of
// t ties within blocks. The chi^2 approximation is conservative. A better one is that of Iman, R.
// L. and Davenport, J. M. 1980, Approximations of the critical region of the Friedman statistic,
// Communications in Statistics A 9(6):
//
//   F = (n-1) chi^2 / (n (k-1) - chi^2),  k - 1 and (k-1)(n-1) degrees of freedom.
//
// If all values are tied in every block, chi^2 and F are 0 and both p-values are 1. If all blocks
// have the same ranks, F is infinite and its p-value is 0; use that of chi^2 then.
struct FriedmanTest {
  std::vector<double> mean_ranks;  // of the treatments; 1 is best
  double chi_squared = 0;
  double degrees = 0;
  double p_value = 1;
  double f = 0;  // of Iman and Davenport
  double f_degrees_1 = 0;
  double f_degrees_2 = 0;
  double f_p_value = 1;
  // Returns the p-value of F, or of chi^2 where F is infinite.
  double get_p() const;
};

// Tests blocks[i][j], the result of treatment j in block i. Also throws std::invalid_argument for
// fewer than 2 blocks or treatments, and for blocks of different lengths.
FriedmanTest calc_friedman_test(std::span<const std::vector<double>> blocks);

// The largest number of pairs for which calc_signed_rank_test() is exact.
inline constexpr int kExactPairs = 50;

// The result of Wilcoxon's signed-rank test, two-sided: do a and b differ in location, pair by
// pair? Source: Wilcoxon, F. 1945, Individual comparisons by ranking methods, Biometrics
// Bulletin 1(6). The differences a - b are ranked by size; equal sizes share the mean of their
// ranks, and pairs without a difference are left out. Under the null hypothesis each difference has
// either sign with probability 1/2. For up to 50 pairs p is exact under this hypothesis, also with
// ties: the distribution of the sum over all 2^n signs, given the ranks. For more pairs it comes
// from the normal approximation
//
//   mean n(n+1)/4,  variance n(n+1)(2n+1)/24 - sum(t^3 - t)/48 over groups of t ties,
//
// without correction for continuity (scipy's correction=False).
//
// The difference between an infinity and a number is larger than any between numbers, and all such
// differences are equal. Two infinities do not differ.
struct SignedRankTest {
  int pairs = 0;                 // pairs that differ; the test uses only these
  int zeros = 0;                 // pairs without a difference
  double positive_rank_sum = 0;  // of the pairs in which a is larger (worse)
  double negative_rank_sum = 0;  // of the pairs in which b is larger
  double p_value = 1;            // 1 if no pair differs
  bool exact = true;
};

// Tests the pairs a[i] and b[i]. Also throws std::invalid_argument for different lengths.
SignedRankTest calc_signed_rank_test(std::span<const double> a, std::span<const double> b);

// Returns the largest rank sum of one side at which this test has a p-value below `level`, for
// `pairs` pairs (at least 1) that differ and without ties. Nothing if no outcome has such a p-value.
// Throws std::invalid_argument for a level outside (0, 1).
std::optional<int> calc_critical_rank_sum(int pairs, double level);

// Adjusts the p-values of several tests, and returns them in their order. Rejecting all hypotheses
// with an adjusted value of at most alpha rejects any true one with probability at most alpha, also
// if the tests depend on each other. Source: Holm, S. 1979, A simple sequentially rejective
// multiple test procedure, Scandinavian Journal of Statistics 6(2): the i-th smallest of m values
// is multiplied by m - i + 1, and is then at least the one before and at most 1. Throws
// std::invalid_argument for a value outside [0, 1].
std::vector<double> adjust_holm(std::span<const double> p_values);

// Returns the probability that a value of a is smaller, and so better, than one of b, where ties
// count half: 1/2 is no difference, 1 means that all of a are better than all of b. Two infinities
// tie. Source: Vargha, A. and Delaney, H. D. 2000, A critique and improvement of the CL common
// language effect size statistics of McGraw and Wong, Journal of Educational and Behavioral
// Statistics 25(2), who define it for being larger and call 0.56, 0.64 and 0.71 small, medium and
// large. Also throws std::invalid_argument for no values.
double calc_a12(std::span<const double> a, std::span<const double> b);

struct WinTieLoss {
  int wins = 0;  // pairs in which a is smaller
  int ties = 0;  // pairs of equal values, also of two infinities
  int losses = 0;
};

// Compares the pairs a[i] and b[i]. Also throws std::invalid_argument for different lengths.
WinTieLoss count_wins(std::span<const double> a, std::span<const double> b);

}  // namespace armwright
