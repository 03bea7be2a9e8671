#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "study/statistics/ranking.hpp"
#include "study/statistics/summary.hpp"
#include "study/statistics/support.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Ranks, SmallestIsFirstAndEqualValuesShare) {
  EXPECT_THAT(calc_ranks(std::vector{30.0, 10.0, 20.0}), ElementsAre(3, 1, 2));
  EXPECT_THAT(calc_ranks(std::vector{2.0, 1.0, 2.0, 2.0}), ElementsAre(3, 1, 3, 3));
  EXPECT_THAT(calc_ranks(std::vector{7.0, 7.0}), ElementsAre(1.5, 1.5));
  EXPECT_THAT(calc_ranks(std::vector{kInf, -1.0, kInf}), ElementsAre(2.5, 1, 2.5));
  EXPECT_THAT(calc_ranks(std::vector{0.0, -0.0}), ElementsAre(1.5, 1.5));
  EXPECT_THAT(calc_ranks({}), IsEmpty());
}

TEST(Ranks, TieTermSumsOverGroups) {
  EXPECT_EQ(calc_tie_term(std::vector{1.0, 2.0, 3.0}), 0);
  // A pair gives 8 - 2, three infinities 27 - 3.
  EXPECT_EQ(calc_tie_term(std::vector{kInf, 1.0, kInf, 5.0, 1.0, kInf}), 30);
}

TEST(Ranks, WhatIsNoValueIsRefused) {
  EXPECT_THAT([] { calc_ranks(std::vector{1.0, kNan}); }, refuses("ranks: number 1 is nan"));
  EXPECT_THAT([] { calc_ranks(std::vector{-kInf}); }, refuses("number 0 is -inf"));
}

TEST(Spread, InterpolatesBetweenOrderStatistics) {
  const std::vector values = {4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(calc_quantile(values, 0), 1);
  EXPECT_EQ(calc_quantile(values, 1), 4);
  EXPECT_EQ(calc_quantile(values, 0.5), 2.5);
  EXPECT_EQ(calc_quantile(values, 0.25), 1.75);  // position 0.75
  const Spread spread = calc_spread(values);
  EXPECT_EQ(spread.median, 2.5);
  EXPECT_EQ(spread.lower_quartile, 1.75);
  EXPECT_EQ(spread.upper_quartile, 3.25);
  EXPECT_EQ(calc_spread(std::vector{5.0}).upper_quartile, 5);
}

TEST(Spread, NextToAnInfinityIsInfiniteAndNeverNan) {
  const std::vector values = {kInf, 1.0, 2.0, kInf, 3.0};
  EXPECT_EQ(calc_quantile(values, 0.5),
            3);  // h is a whole number, so the next value does not matter
  EXPECT_EQ(calc_quantile(values, 0.501), kInf);
  EXPECT_EQ(calc_quantile(values, 0.9), kInf);  // between two of them
  EXPECT_EQ(calc_quantile(values, 1), kInf);
}

TEST(Spread, RefusesNoValuesAndOtherProbabilities) {
  EXPECT_THAT([] { calc_quantile({}, 0.5); }, refuses("there are no values"));
  EXPECT_THAT([] { calc_spread({}); }, refuses("there are no values"));
  EXPECT_THAT([] { calc_quantile(std::vector{1.0}, 1.5); }, refuses("p is 1.5"));
  EXPECT_THAT([] { calc_quantile(std::vector{1.0}, kNan); }, refuses("p is nan"));
  EXPECT_THAT([] { calc_spread(std::vector{kNan}); }, refuses("number 0 is nan"));
}

double calc_mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(Bootstrap, IntervalIsThatOfTheResampledStatistic) {
  // Means of two draws from {0, 1}: 0, 1/2 and 1 with probabilities 1/4, 1/2 and 1/4.
  const std::vector values = {0.0, 1.0};
  const Interval inner = calc_bootstrap_interval(values, calc_mean, 0.4, 10000, "mean");
  EXPECT_EQ(inner.lower, 0.5);
  EXPECT_EQ(inner.upper, 0.5);
  const Interval outer = calc_bootstrap_interval(values, calc_mean, 0.6, 10000, "mean");
  EXPECT_EQ(outer.lower, 0);
  EXPECT_EQ(outer.upper, 1);
}

TEST(Bootstrap, DependsOnTheStreamAndOnNothingElse) {
  std::vector<double> values;
  for (int i = 0; i < 15; ++i) {
    values.push_back(i * i);
  }
  const Interval first = calc_bootstrap_interval(values, calc_mean, 0.95, 100, "a");
  const Interval again = calc_bootstrap_interval(values, calc_mean, 0.95, 100, "a");
  const Interval other = calc_bootstrap_interval(values, calc_mean, 0.95, 100, "b");
  EXPECT_EQ(first.lower, again.lower);
  EXPECT_EQ(first.upper, again.upper);
  EXPECT_NE(first.lower, other.lower);
}

TEST(Bootstrap, CoversTheMedianAboutAsOftenAsItSays) {
  int covered = 0;
  constexpr int kStudies = 400;
  for (int study = 0; study < kStudies; ++study) {
    RandomStream random("bootstrap-coverage", study);
    std::vector<double> values(25);
    for (double& value : values) {
      value = random.normal();
    }
    const Interval interval =
        calc_median_interval(values, 0.95, 400, "coverage/" + std::to_string(study));
    covered += interval.lower <= 0 && interval.upper >= 0 ? 1 : 0;
  }
  // 95 % of 400 is 380, its standard deviation 4.4; the percentile interval is a little short.
  EXPECT_GE(covered, 360);
  EXPECT_LE(covered, 395);
}

TEST(Bootstrap, RefusesWhatHasNoInterval) {
  const std::vector values = {1.0, 2.0};
  EXPECT_THAT([] { calc_median_interval({}, 0.95, 10, "s"); }, refuses("no values"));
  EXPECT_THAT([&] { calc_median_interval(values, 1, 10, "s"); }, refuses("level"));
  EXPECT_THAT([&] { calc_median_interval(values, 0, 10, "s"); }, refuses("level"));
  EXPECT_THAT([&] { calc_median_interval(values, 0.95, 0, "s"); }, refuses("at least one"));
  EXPECT_THAT([] { calc_median_interval(std::vector{kNan}, 0.95, 10, "s"); }, refuses("is nan"));
}

}  // namespace
}  // namespace armwright
