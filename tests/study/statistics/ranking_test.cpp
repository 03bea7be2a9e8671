#include "study/statistics/ranking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "study/statistics/support.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using Table = std::vector<std::vector<double>>;

TEST(Ranking, IsByMeanRankOverProblems) {
  const Ranking ranking = calc_ranking(Table{{3, 1, 2}, {0.3, 0.1, kInf}});
  EXPECT_THAT(ranking.mean_ranks, ElementsAre(2.5, 1, 2.5));
  EXPECT_THAT(ranking.order, ElementsAre(1, 0, 2));
  EXPECT_THAT(ranking.leaders, ElementsAre(1));
}

TEST(Ranking, MayHaveSeveralLeaders) {
  const Ranking ranking = calc_ranking(Table{{9, 1, 2, 4}, {9, 2, 1, kInf}, {9, 1, 1, 3}});
  EXPECT_THAT(ranking.order, ElementsAre(1, 2, 3, 0));
  EXPECT_THAT(ranking.leaders, ElementsAre(1, 2));
}

TEST(Ranking, StabilityLeavesOutOneProblemAfterTheOther) {
  const Table medians = {{2, 1, 3}, {2, 1, 3}, {1, 3, 2}, {1, 3, 2}};
  const RankingStability stability = calc_ranking_stability(medians);
  EXPECT_THAT(stability.full.mean_ranks, ElementsAre(1.5, 2, 2.5));
  ASSERT_THAT(stability.without, SizeIs(4));
  const RankingWithout& first = stability.without[0];  // sums 4, 7, 7
  EXPECT_EQ(first.problem, 0U);
  EXPECT_THAT(first.ranking.order, ElementsAre(0, 1, 2));
  EXPECT_DOUBLE_EQ(first.tau, 2 / std::sqrt(3 * 2.0));
  EXPECT_FALSE(first.leader_changes);
  const RankingWithout& last = stability.without[3];  // sums 5, 5, 8: one joins the leader
  EXPECT_EQ(last.problem, 3U);
  EXPECT_THAT(last.ranking.leaders, ElementsAre(0, 1));
  EXPECT_TRUE(last.leader_changes);
}

TEST(Ranking, StabilityTellsAnotherLeader) {
  const RankingStability stability = calc_ranking_stability(Table{{1, 3, 2}, {2, 1, 3}});
  EXPECT_THAT(stability.full.leaders, ElementsAre(0));
  EXPECT_THAT(stability.without[0].ranking.leaders, ElementsAre(1));
  EXPECT_TRUE(stability.without[0].leader_changes);
  EXPECT_THAT(stability.without[1].ranking.leaders, ElementsAre(0));
  EXPECT_FALSE(stability.without[1].leader_changes);
}

TEST(Ranking, OfOneProblemHasNothingToLeaveOut) {
  EXPECT_THAT(calc_ranking_stability(Table{{2, 1}}).without, IsEmpty());
  EXPECT_THAT([] { calc_ranking_stability({}); }, refuses("ranking: there are no numbers"));
  EXPECT_THAT([] { calc_ranking(Table{{1, 2}, {1}}); }, refuses("one row has 2"));
  EXPECT_THAT([] { calc_ranking(Table{{1, kNan}}); }, refuses("nan"));
}

TEST(KendallTau, CountsPairsInTheSameOrder) {
  const std::vector up = {1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(calc_kendall_tau(up, up), 1);
  EXPECT_EQ(calc_kendall_tau(up, std::vector{9.0, 5.0, 2.0, -1.0}), -1);
  EXPECT_DOUBLE_EQ(calc_kendall_tau(up, std::vector{1.0, 2.0, 4.0, 3.0}), 4 / 6.0);
  EXPECT_EQ(calc_kendall_tau(up, std::vector{7.0, 7.0, 7.0, 7.0}), 0);
  EXPECT_EQ(calc_kendall_tau(std::vector{2.0, 2.0}, std::vector{kInf, kInf}), 1);
  EXPECT_EQ(calc_kendall_tau(std::vector{2.0}, std::vector{3.0}), 1);
  EXPECT_THAT([&] { calc_kendall_tau(up, std::vector{1.0}); }, refuses("cannot be paired"));
}

}  // namespace
}  // namespace armwright
