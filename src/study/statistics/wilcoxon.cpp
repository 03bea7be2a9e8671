#include "study/statistics/wilcoxon.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

#include "study/statistics/ranks.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

// Twice the probability that the ranks with random signs have a positive sum of at most `sum`, the
// smaller of the two observed. Counts are whole numbers up to 2^50, and so exact.
double calc_exact_p(const std::vector<double>& ranks, double sum) {
  // Ranks are whole numbers or halves: doubled, they index the sums that are possible.
  std::vector<double> ways = {1};  // ways[s]: how many choices of signs give the doubled sum s
  for (const double rank : ranks) {
    const auto doubled = static_cast<std::size_t>(2 * rank);
    ways.resize(ways.size() + doubled, 0);
    for (std::size_t s = ways.size(); s-- > doubled;) {
      ways[s] += ways[s - doubled];
    }
  }
  const auto last = static_cast<std::size_t>(2 * sum);
  double favourable = 0;
  for (std::size_t s = 0; s <= last; ++s) {
    favourable += ways[s];
  }
  return std::min(1.0, std::ldexp(favourable, 1 - static_cast<int>(ranks.size())));
}

double calc_normal_p(double pairs, double tie_term, double sum) {
  const double mean = pairs * (pairs + 1) / 4;
  const double variance = pairs * (pairs + 1) * (2 * pairs + 1) / 24 - tie_term / 48;
  const double z = std::abs(sum - mean) / std::sqrt(variance);
  return 2 * cdf(complement(boost::math::normal(), z));
}

}  // namespace

SignedRankTest calc_signed_rank_test(std::span<const double> a, std::span<const double> b) {
  check_pairs(a, b, "signed-rank test");
  SignedRankTest test;
  std::vector<double> sizes;
  std::vector<bool> positive;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) {
      ++test.zeros;
      continue;
    }
    sizes.push_back(std::abs(a[i] - b[i]));
    positive.push_back(a[i] > b[i]);
  }
  test.pairs = static_cast<int>(sizes.size());
  const std::vector<double> ranks = calc_ranks(sizes);
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    (positive[i] ? test.positive_rank_sum : test.negative_rank_sum) += ranks[i];
  }
  const double smaller = std::min(test.positive_rank_sum, test.negative_rank_sum);
  test.exact = test.pairs <= kExactPairs;
  test.p_value = test.exact ? calc_exact_p(ranks, smaller)
                            : calc_normal_p(test.pairs, calc_tie_term(sizes), smaller);
  return test;
}

}  // namespace armwright
