#include "study/statistics/friedman.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <limits>
#include <stdexcept>

#include "study/statistics/ranks.hpp"
#include "study/statistics/values.hpp"

namespace armwright {

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

}  // namespace armwright
