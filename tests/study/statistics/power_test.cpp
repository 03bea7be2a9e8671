#include "study/statistics/power.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

#include "base/random.hpp"
#include "sample_or_all.hpp"
#include "study/statistics/significance.hpp"
#include "study/statistics/support.hpp"

namespace armwright {
namespace {

// Returns the share of studies in which the better optimizer is found significantly better. Each
// study draws the runs of both optimizers and does the program's own test.
double count_found(int pairs, double a12, std::size_t tests, int studies) {
  const double shift = std::sqrt(2.0) * quantile(boost::math::normal(), a12);
  int found = 0;
  for (int study = 0; study < studies; ++study) {
    RandomStream random("power test", static_cast<std::uint64_t>(study));
    std::vector<double> a, b;
    for (int i = 0; i < pairs; ++i) {
      a.push_back(random.normal());
      b.push_back(random.normal() + shift);
    }
    const SignedRankTest test = calc_signed_rank_test(a, b);
    found += test.p_value * static_cast<double>(tests) < kSignificance &&
                     test.negative_rank_sum > test.positive_rank_sum
                 ? 1
                 : 0;
  }
  return static_cast<double>(found) / studies;
}

// Both sides are simulations: 4 standard errors of their difference. The normal approximation is
// exact within 1 % at these numbers of pairs.
TEST(Power, IsTheShareOfStudiesThatFindTheDifference) {
  constexpr int kStudies = 4000;
  const double tolerance = 4 * std::sqrt(0.25 / kStudies + 0.25 / 5000);
  for (const int pairs : sample_or_all<std::vector<int>>({15, 60}, {9, 15, 30, 50, 60, 140})) {
    for (const double a12 : {0.56, 0.64, 0.71, 0.9}) {
      for (const std::size_t tests : sample_or_all<std::vector<std::size_t>>({6}, {1, 6, 66})) {
        EXPECT_NEAR(calc_power(pairs, a12, tests), count_found(pairs, a12, tests, kStudies),
                    tolerance)
            << pairs << " pairs, A12 " << a12 << ", " << tests << " tests";
      }
    }
  }
}

TEST(Power, OfNoDifferenceIsAtMostHalfTheLevel) {
  EXPECT_NEAR(calc_power(15, 0.5, 1), 0.025, 4 * std::sqrt(0.025 / 5000));
  EXPECT_NEAR(calc_power(80, 0.5, 1), 0.025, 0.002);
}

// The number of pairs at which the exact test ends joins two ways to compute.
TEST(Power, BothWaysToComputeAgreeWhereTheyMeet) {
  for (const double a12 : {0.6, 0.64, 0.7}) {
    EXPECT_NEAR(calc_power(kExactPairs, a12, 3), calc_power(kExactPairs + 1, a12, 3), 0.03);
  }
}

TEST(Power, TheDetectableDifferenceIsFoundInFourOfFiveStudies) {
  for (const int pairs : {10, 15, 60}) {
    for (const std::size_t tests : {1, 6}) {
      const double a12 = find_detectable_a12(pairs, tests);
      EXPECT_GE(calc_power(pairs, a12, tests), kPower);
      EXPECT_LT(calc_power(pairs, a12 - 0.002, tests), kPower);
    }
  }
}

TEST(Power, TheNeededPairsSufficeAndOneLessDoesNot) {
  for (const std::size_t tests : {1, 6, 66}) {
    for (const double a12 : {kMediumA12, 0.9}) {
      const int pairs = find_needed_pairs(a12, tests);
      EXPECT_GE(calc_power(pairs, a12, tests), kPower);
      EXPECT_LT(calc_power(pairs - 1, a12, tests), kPower);
    }
  }
}

TEST(Power, TooFewPairsFindNothing) {
  EXPECT_FALSE(can_be_significant(5, 1));
  EXPECT_TRUE(can_be_significant(6, 1));
  EXPECT_FALSE(can_be_significant(6, 2));  // 2 x 2 / 2^6 > 0.05
  EXPECT_FALSE(can_be_significant(8, 10));
  EXPECT_TRUE(can_be_significant(9, 10));
  EXPECT_EQ(find_fewest_pairs(1), 6);
  EXPECT_EQ(find_fewest_pairs(10), 9);
  EXPECT_EQ(calc_power(6, 0.99, 2), 0);
  EXPECT_THAT([] { find_detectable_a12(6, 2); }, refuses("no outcome of so few pairs"));
}

TEST(Power, RefusesWhatIsNoQuestion) {
  EXPECT_THAT([] { calc_power(15, 1, 1); }, refuses("A12 is 1"));
  EXPECT_THAT([] { calc_power(15, 0.6, 0); }, refuses("at least one test"));
  EXPECT_THAT([] { find_needed_pairs(0.5, 1); }, refuses("above 0.5"));
}

}  // namespace
}  // namespace armwright
