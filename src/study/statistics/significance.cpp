#include "study/statistics/significance.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "study/statistics/ranking.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

// Returns how many choices of signs give the positive ranks each doubled sum; the index is the
// doubled sum, because ranks are whole numbers or halves. Counts are whole numbers up to 2^50, so
// they are exact.
std::vector<double> count_signs(const std::vector<double>& ranks) {
  std::vector<double> ways = {1};
  for (const double rank : ranks) {
    const auto doubled = static_cast<std::size_t>(2 * rank);
    ways.resize(ways.size() + doubled, 0);
    for (std::size_t s = ways.size(); s-- > doubled;) {
      ways[s] += ways[s - doubled];
    }
  }
  return ways;
}

// Returns twice the probability that the positive ranks, with random signs, have a sum of at most
// `sum`, the smaller of the two observed sums.
double calc_exact_p(const std::vector<double>& ranks, double sum) {
  const std::vector<double> ways = count_signs(ranks);
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

FriedmanTest calc_friedman_test(std::span<const std::vector<double>> blocks) {
  const std::size_t treatments = check_table(blocks, "Friedman test");
  if (blocks.size() < 2 || treatments < 2) {
    throw std::invalid_argument("Friedman test: it takes at least 2 blocks and 2 treatments");
  }
  const auto n = static_cast<double>(blocks.size());
  const auto k = static_cast<double>(treatments);
  std::vector<double> rank_sums(treatments, 0);
  double ties = 0;
  for (const std::vector<double>& block : blocks) {
    const std::vector<double> ranks = calc_ranks(block);
    for (std::size_t j = 0; j < treatments; ++j) {
      rank_sums[j] += ranks[j];
    }
    ties += calc_tie_term(block);
  }
  FriedmanTest test;
  // chi^2 = 3 (k-1) between / within and F = 3 (n-1) between / (n within - 3 between), of whole
  // numbers: complete agreement, where F's denominator is 0, is found exactly.
  double between = 0;
  for (const double sum : rank_sums) {
    test.mean_ranks.push_back(sum / n);
    const double deviation = 2 * sum - n * (k + 1);
    between += deviation * deviation;
  }
  const double within = n * k * (k + 1) * (k - 1) - ties;
  const double disagreement = n * within - 3 * between;
  test.degrees = k - 1;
  test.f_degrees_1 = k - 1;
  test.f_degrees_2 = (k - 1) * (n - 1);
  if (within == 0) {
    return test;
  }
  test.chi_squared = 3 * (k - 1) * between / within;
  test.p_value = cdf(complement(boost::math::chi_squared(test.degrees), test.chi_squared));
  if (disagreement == 0) {
    test.f = std::numeric_limits<double>::infinity();
    test.f_p_value = 0;
    return test;
  }
  test.f = 3 * (n - 1) * between / disagreement;
  const boost::math::fisher_f distribution(test.f_degrees_1, test.f_degrees_2);
  test.f_p_value = cdf(complement(distribution, test.f));
  return test;
}

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

double FriedmanTest::get_p() const {
  return std::isfinite(f) ? f_p_value : p_value;
}

std::optional<int> calc_critical_rank_sum(int pairs, double level) {
  check_range(pairs, 1, std::numeric_limits<int>::max(), "signed-rank test: the number of pairs");
  if (!(level > 0 && level < 1)) {
    throw std::invalid_argument("signed-rank test: the level must lie between 0 and 1");
  }
  if (pairs > kExactPairs) {
    const double n = pairs;
    const double deviation = std::sqrt(n * (n + 1) * (2 * n + 1) / 24);
    const double z = quantile(complement(boost::math::normal(), level / 2));
    double sum = std::floor(n * (n + 1) / 4 - z * deviation);
    sum -= calc_normal_p(n, 0, sum) < level ? 0 : 1;  // the bound itself is not below the level
    return sum < 0 ? std::nullopt : std::optional(static_cast<int>(sum));
  }
  std::vector<double> ranks(static_cast<std::size_t>(pairs));
  std::iota(ranks.begin(), ranks.end(), 1.0);
  const std::vector<double> ways = count_signs(ranks);
  std::optional<int> critical;
  double favourable = 0;
  for (int sum = 0;; ++sum) {
    favourable += ways[2 * static_cast<std::size_t>(sum)];
    if (std::ldexp(favourable, 1 - pairs) >= level) {
      return critical;
    }
    critical = sum;
  }
}

std::vector<double> adjust_holm(std::span<const double> p_values) {
  for (const double p : p_values) {
    check_range(p, 0, 1, "Holm's adjustment: a p-value");
  }
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto hypotheses = static_cast<double>(order.size() - i);  // not rejected so far
    largest = std::max(largest, std::min(1.0, hypotheses * p_values[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

double calc_a12(std::span<const double> a, std::span<const double> b) {
  if (a.empty() || b.empty()) {
    throw std::invalid_argument("A12: there are no values");
  }
  check_values(a, "A12");
  check_values(b, "A12");
  double better = 0;  // exact: halves and whole numbers
  for (const double x : a) {
    for (const double y : b) {
      better += x < y ? 1 : (x == y ? 0.5 : 0);
    }
  }
  return better / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

WinTieLoss count_wins(std::span<const double> a, std::span<const double> b) {
  check_pairs(a, b, "wins");
  WinTieLoss count;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ++(a[i] < b[i] ? count.wins : (a[i] == b[i] ? count.ties : count.losses));
  }
  return count;
}

}  // namespace armwright
