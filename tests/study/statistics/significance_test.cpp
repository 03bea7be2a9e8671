#include "study/statistics/significance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "study/statistics/support.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using Table = std::vector<std::vector<double>>;

std::vector<double> make_steps(int n) {
  std::vector<double> values;
  for (int i = 1; i <= n; ++i) {
    values.push_back(i);
  }
  return values;
}

TEST(SignedRank, AllOnOneSideHasTheSmallestP) {
  for (const int n : {1, 2, 5, 6, 20, 50}) {
    const std::vector<double> a(n, 0);
    const SignedRankTest test = calc_signed_rank_test(a, make_steps(n));
    EXPECT_EQ(test.pairs, n);
    EXPECT_EQ(test.zeros, 0);
    EXPECT_EQ(test.positive_rank_sum, 0);
    EXPECT_EQ(test.negative_rank_sum, n * (n + 1) / 2);
    EXPECT_EQ(test.p_value, std::ldexp(1.0, 1 - n));  // two of the 2^n choices of signs
    EXPECT_TRUE(test.exact);
  }
}

TEST(SignedRank, CountsTheSetsOfRanksWithASumAsSmall) {
  // Of 10 pairs, those with the ranks 1, 2 and 5 are positive. The numbers of sets of different
  // ranks with the sums 0, ..., 8 are 1, 1, 1, 2, 2, 3, 4, 5 and 6, together 25.
  std::vector<double> a = make_steps(10);
  for (const int rank : {3, 4, 6, 7, 8, 9, 10}) {
    a[rank - 1] = -rank;
  }
  const SignedRankTest test = calc_signed_rank_test(a, std::vector<double>(10, 0));
  EXPECT_EQ(test.positive_rank_sum, 8);
  EXPECT_EQ(test.negative_rank_sum, 47);
  EXPECT_EQ(test.p_value, 2 * 25 / 1024.0);
}

TEST(SignedRank, TiesShareRanksAndTheDistributionKnows) {
  // Ranks 3/2, 3/2 and 3; one of the small ones is positive. 3 of 8 sums are as small: 0, 3/2, 3/2.
  const SignedRankTest test =
      calc_signed_rank_test(std::vector{1.0, 0.0, 0.0}, std::vector{0.0, 1.0, 2.0});
  EXPECT_EQ(test.positive_rank_sum, 1.5);
  EXPECT_EQ(test.negative_rank_sum, 4.5);
  EXPECT_EQ(test.p_value, 0.75);
}

TEST(SignedRank, PairsWithoutDifferenceAreLeftOut) {
  const SignedRankTest test =
      calc_signed_rank_test(std::vector{5.0, 1.0, kInf, 0.0}, std::vector{5.0, 2.0, kInf, -0.0});
  EXPECT_EQ(test.pairs, 1);
  EXPECT_EQ(test.zeros, 3);
  EXPECT_EQ(test.p_value, 1);
  EXPECT_EQ(calc_signed_rank_test({}, {}).p_value, 1);
  const SignedRankTest none = calc_signed_rank_test(std::vector{kInf, 2.0}, std::vector{kInf, 2.0});
  EXPECT_EQ(none.pairs, 0);
  EXPECT_EQ(none.zeros, 2);
  EXPECT_EQ(none.p_value, 1);
}

TEST(SignedRank, AnInfinityDiffersMostAndAllOfThemAlike) {
  const SignedRankTest test =
      calc_signed_rank_test(std::vector{kInf, 1.0, -1e300}, std::vector{1.0, kInf, 5.0});
  EXPECT_EQ(test.positive_rank_sum, 2.5);
  EXPECT_EQ(test.negative_rank_sum, 3.5);
}

TEST(SignedRank, IsExactUpToFiftyPairsThatDiffer) {
  std::vector<double> a = make_steps(51);
  a.push_back(0);
  const std::vector<double> b(52, 0);
  EXPECT_FALSE(calc_signed_rank_test(a, b).exact);
  a[3] = 0;
  EXPECT_TRUE(calc_signed_rank_test(a, b).exact);
}

TEST(SignedRank, SwappingTheSidesChangesOnlyTheSums) {
  const std::vector a = {0.3, 1.2, kInf, 4.0, 2.0, 2.5, 7.0};
  const std::vector b = {0.1, 1.9, 3.0, 4.0, kInf, 1.5, 1.0};
  const SignedRankTest one = calc_signed_rank_test(a, b);
  const SignedRankTest two = calc_signed_rank_test(b, a);
  EXPECT_EQ(one.p_value, two.p_value);
  EXPECT_EQ(one.positive_rank_sum, two.negative_rank_sum);
  EXPECT_EQ(one.negative_rank_sum, two.positive_rank_sum);
}

TEST(SignedRank, RefusesWhatIsNoPair) {
  EXPECT_THAT([] { calc_signed_rank_test(std::vector{1.0}, {}); }, refuses("cannot be paired"));
  EXPECT_THAT([] { calc_signed_rank_test(std::vector{1.0}, std::vector{kNan}); }, refuses("nan"));
}

// The largest rank sum with a p-value below the level, found here by the test itself.
TEST(SignedRank, TheCriticalRankSumIsTheLastBelowTheLevel) {
  const auto calc_p = [](int pairs, int sum) {
    std::vector<double> a = make_steps(pairs);
    for (int rank = pairs; rank > 0; --rank) {  // each sum is a sum of different ranks
      if (rank <= sum) {
        a[static_cast<std::size_t>(rank - 1)] = -rank;
        sum -= rank;
      }
    }
    return calc_signed_rank_test(a, std::vector<double>(static_cast<std::size_t>(pairs), 0))
        .p_value;
  };
  for (const int pairs : {6, 9, 15, 50, 51, 200}) {
    for (const double level : {0.05, 0.05 / 6, 0.05 / 66}) {
      const auto critical = calc_critical_rank_sum(pairs, level);
      const double least = calc_p(pairs, 0);
      ASSERT_EQ(critical.has_value(), least < level) << pairs << " " << level;
      if (critical) {
        EXPECT_LT(calc_p(pairs, *critical), level) << pairs << " " << level;
        EXPECT_GE(calc_p(pairs, *critical + 1), level) << pairs << " " << level;
      }
    }
  }
  EXPECT_EQ(calc_critical_rank_sum(6, 1 / 32.0), std::nullopt);  // p = 1/32 is not below it
  EXPECT_THAT([] { calc_critical_rank_sum(0, 0.05); }, refuses("must lie from 1"));
  EXPECT_THAT([] { calc_critical_rank_sum(6, 1); }, refuses("between 0 and 1"));
}

TEST(Friedman, IsItsEquationsOnASmallTable) {
  // Ranks (1,2,3), (1,3,2), (1,2,3): sums 3, 7 and 8, which differ from 6 by -3, 1 and 2.
  const FriedmanTest test = calc_friedman_test(
      std::vector<std::vector<double>>{{0.1, 0.2, 0.3}, {10, 30, 20}, {-9, 0, kInf}});
  EXPECT_THAT(test.mean_ranks, ElementsAre(1, 7 / 3.0, 8 / 3.0));
  EXPECT_DOUBLE_EQ(test.chi_squared, 12 * 14 / 36.0);
  EXPECT_EQ(test.degrees, 2);
  EXPECT_NEAR(test.p_value, std::exp(-7 / 3.0), 1e-15);  // of two degrees of freedom
  EXPECT_DOUBLE_EQ(test.f, 7);
  EXPECT_EQ(test.f_degrees_1, 2);
  EXPECT_EQ(test.f_degrees_2, 4);
  EXPECT_NEAR(test.f_p_value, std::pow(1 + 2 * 7 / 4.0, -2), 1e-15);  // of two and any degrees
}

TEST(Friedman, OfCompleteAgreementHasAnInfiniteF) {
  // This also holds with ties, if they are the same in all blocks; 5 blocks: chi^2 = 5 (3 - 1).
  for (const std::vector<double>& block : {std::vector{0.1, 0.2, 0.7}, {0.3, 0.3, 0.4}}) {
    const FriedmanTest test = calc_friedman_test(std::vector(5, block));
    EXPECT_DOUBLE_EQ(test.chi_squared, 10);
    EXPECT_NEAR(test.p_value, std::exp(-5), 1e-15);
    EXPECT_EQ(test.f, kInf);
    EXPECT_EQ(test.f_p_value, 0);
    EXPECT_EQ(test.get_p(), test.p_value);
  }
}

TEST(Friedman, OfTiesAloneFindsNothing) {
  const FriedmanTest test =
      calc_friedman_test(std::vector<std::vector<double>>{{1, 1, 1}, {kInf, kInf, kInf}});
  EXPECT_THAT(test.mean_ranks, Each(2));
  EXPECT_EQ(test.chi_squared, 0);
  EXPECT_EQ(test.p_value, 1);
  EXPECT_EQ(test.f, 0);
  EXPECT_EQ(test.f_p_value, 1);
}

TEST(Friedman, RefusesTablesWithoutQuestion) {
  EXPECT_THAT([] { calc_friedman_test({}); }, refuses("no numbers"));
  EXPECT_THAT([] { calc_friedman_test(Table{{1, 2}}); }, refuses("at least 2 blocks"));
  EXPECT_THAT([] { calc_friedman_test(Table{{1}, {2}}); }, refuses("2 treatments"));
  EXPECT_THAT([] { calc_friedman_test(Table{{1, 2}, {2}}); }, refuses("one row has 2"));
  EXPECT_THAT([] { calc_friedman_test(Table{{1, 2}, {2, kNan}}); }, refuses("nan"));
}

TEST(Holm, MultipliesByWhatIsLeftAndNeverFallsBack) {
  EXPECT_THAT(adjust_holm(std::vector{0.25, 0.03125, 0.125}), ElementsAre(0.25, 0.09375, 0.25));
  EXPECT_THAT(adjust_holm(std::vector{0.5, 0.75, 0.0}), ElementsAre(1, 1, 0));
  EXPECT_THAT(adjust_holm(std::vector{0.04}), ElementsAre(0.04));
  EXPECT_THAT(adjust_holm({}), IsEmpty());
  EXPECT_THAT([] { adjust_holm(std::vector{0.5, 1.1}); }, refuses("a p-value is 1.1"));
  EXPECT_THAT([] { adjust_holm(std::vector{kNan}); }, refuses("a p-value is nan"));
}

TEST(EffectSize, A12IsTheProbabilityOfBeingSmaller) {
  EXPECT_EQ(calc_a12(std::vector{1.0, 2.0}, std::vector{3.0, 4.0, kInf}), 1);
  EXPECT_EQ(calc_a12(std::vector{3.0, kInf}, std::vector{1.0, 2.0}), 0);
  EXPECT_EQ(calc_a12(std::vector{kInf, 1.0}, std::vector{kInf, 1.0}), 0.5);
  EXPECT_EQ(calc_a12(std::vector{1.0, 5.0}, std::vector{1.0, 4.0}), 0.375);  // 1/2 and 1, of 4
  EXPECT_THAT([] { calc_a12({}, std::vector{1.0}); }, refuses("no values"));
  EXPECT_THAT([] { calc_a12(std::vector{1.0}, {}); }, refuses("no values"));
  EXPECT_THAT([] { calc_a12(std::vector{1.0}, std::vector{kNan}); }, refuses("nan"));
}

TEST(EffectSize, WinsAreCountedPairByPair) {
  const WinTieLoss count = count_wins(std::vector{1.0, 2.0, kInf, kInf, 0.0, 3.0},
                                      std::vector{2.0, 1.0, kInf, 9.0, 5.0, kInf});
  EXPECT_EQ(count.wins, 3);
  EXPECT_EQ(count.ties, 1);
  EXPECT_EQ(count.losses, 2);
  EXPECT_THAT([] { count_wins(std::vector{1.0}, {}); }, refuses("cannot be paired"));
  EXPECT_THAT([] { count_wins(std::vector{kNan}, std::vector{1.0}); }, refuses("is nan"));
  EXPECT_THAT([] { count_wins(std::vector{1.0}, std::vector{kNan}); }, refuses("is nan"));
}

}  // namespace
}  // namespace armwright
