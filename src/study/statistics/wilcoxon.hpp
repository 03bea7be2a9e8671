// Wilcoxon's signed-rank test of pairs, two-sided: do a and b differ in location, pair by pair?
// Source: Wilcoxon, F. 1945, Individual comparisons by ranking methods, Biometrics Bulletin 1(6).
// The differences a - b are ranked by size; equal sizes share the mean of their ranks, and pairs
// without difference are left out. If nothing distinguishes a from b, each difference had either
// sign with probability 1/2. Of up to 50 pairs p is exact under just that, ties included (the
// distribution of the sum over all 2^n signs, given the ranks). Beyond, it comes from the normal
// approximation with mean n(n+1)/4 and variance n(n+1)(2n+1)/24 - sum(t^3 - t)/48 over ties of t,
// without correction for continuity (scipy's correction=False).
//
// An infinity against a number is a larger difference than any between numbers, and as large as
// any other such; two infinities do not differ.
#pragma once

#include <span>

namespace armwright {

inline constexpr int kExactPairs = 50;

struct SignedRankTest {
  int pairs = 0;                 // that differ: the ones that the test is of
  int zeros = 0;                 // left out
  double positive_rank_sum = 0;  // of the pairs where a is larger (worse)
  double negative_rank_sum = 0;  // of the pairs where b is
  double p_value = 1;            // two-sided; 1 if no pair differs
  bool exact = true;
};

// a[i] and b[i] are a pair. Throws std::invalid_argument for unequal lengths, NaN and -infinity.
SignedRankTest calc_signed_rank_test(std::span<const double> a, std::span<const double> b);

}  // namespace armwright
