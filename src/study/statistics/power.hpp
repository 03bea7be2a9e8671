// The power of a comparison before it runs: the probability that a given difference between two
// optimizers becomes significant.
//
// Model: the paired differences of two optimizers are independent and normal with variance 1 and a
// shift z (in their own unit), so P(a is better in a pair) = Phi(z). If the two runs of a pair are
// independent and normal with equal variances, this probability is also A12 (Vargha and Delaney
// 2000), so z = Phi^-1(A12). If runs of a pair are alike because they share cases and start, the
// same A12 is easier to find; the power here is then too low.
//
// The test is the one of calc_signed_rank_test() at the level kSignificance / tests. Holm's
// procedure uses this level until a first pair is significant, and larger ones afterwards. The
// power after Holm is therefore at least the power here.
//
// All functions throw std::invalid_argument for fewer than one test and for an A12 outside (0, 1).
#pragma once

#include <cstddef>

namespace armwright {

// The power that predictions ask for.
inline constexpr double kPower = 0.8;
// The A12 that Vargha and Delaney call medium.
inline constexpr double kMediumA12 = 0.64;

// Returns whether the clearest outcome, all pairs in the same direction, is significant.
bool can_be_significant(int pairs, std::size_t tests);
// Returns the smallest number of pairs with which the clearest outcome is significant.
int find_fewest_pairs(std::size_t tests);

// Returns the probability that the better optimizer is found significantly better. Up to
// kExactPairs pairs this is a simulation of 5000 studies with fixed random numbers (standard error
// at most 0.007); beyond, the normal approximation of the rank sum with its exact mean and variance
// under the model: Lehmann, E. L. 1975, Nonparametrics, appendix, section 4.
double calc_power(int pairs, double a12, std::size_t tests);

// Returns the smallest A12 above 1/2 that is found with the probability kPower, within 0.001. Throws
// std::invalid_argument if no outcome can be significant.
double find_detectable_a12(int pairs, std::size_t tests);

// Returns a number of pairs with which this A12, which must be above 1/2, is found with the
// probability kPower, and with one pair less is not. Exact p-values come in steps, so a somewhat
// smaller number can suffice, too.
int find_needed_pairs(double a12, std::size_t tests);

}  // namespace armwright
