// Differences within a problem's resolution decide nothing.
#include <gmock/gmock.h>

#include <algorithm>

#include "study/analysis/analysis_support.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;

TEST(ResultMargin, RoundingNoiseIsNoWin) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 15);
  std::vector<double> a, b;
  for (int i = 0; i < 15; ++i) {
    a.push_back(2e-16 * (i + 1));
    b.push_back(8e-30);
  }
  const ProblemResult problem = analyze_values(plan, {a, b}).problems.front();
  EXPECT_EQ(problem.pairs.front().test.zeros, 15);
  EXPECT_EQ(problem.pairs.front().p_holm, 1);
  EXPECT_EQ(problem.pairs.front().a12, 0.5);
  EXPECT_EQ(problem.pairs.front().wins.ties, 15);
  EXPECT_EQ(problem.friedman->get_p(), 1);
  EXPECT_EQ(problem.optimizers[0].mean_rank, 1.5);
  EXPECT_EQ(problem.optimizers[0].successes, 15);
  EXPECT_EQ(problem.best_known, 0);
}

// The medians are 4.3e-16 and 4.7e-16, but the first optimizer fails in six of fifteen runs.
TEST(ResultMargin, AllSuccessesLeadNineOfFifteen) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 15);
  std::vector<double> nine(15, 4.3e-16), all(15, 4.7e-16);
  std::fill(nine.begin() + 9, nine.end(), 3.0);
  const ProblemResult problem = analyze_values(plan, {nine, all}).problems.front();
  ASSERT_LT(problem.optimizers[0].spread.median, problem.optimizers[1].spread.median);
  EXPECT_EQ(problem.optimizers[0].successes, 9);
  EXPECT_EQ(problem.optimizers[1].successes, 15);
  EXPECT_THAT(problem.order, ElementsAre(1u, 0u));
}

TEST(ResultMargin, WithoutAKnownOptimumEveryValueIsASuccess) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 6);
  const Margin margin{.resolution = 1e-6};
  EXPECT_TRUE(margin.is_success(1e9));
  EXPECT_FALSE(margin.is_success(kInfinity));
  StudyPlan failures = plan;
  failures.value = StudyValue::failures;
  EXPECT_EQ(make_margin(failures, plan.problems.front()).resolution, 0);
  EXPECT_EQ(make_margin(failures, plan.problems.front()).optimum, std::nullopt);
  EXPECT_EQ(make_margin(plan, plan.problems.front()).resolution, 1e-8);
  EXPECT_EQ(make_margin(plan, plan.problems.front()).optimum, 0);
}

// Over problems, medians within the resolution are equal, also as shares of the way to the optimum.
TEST(ResultMargin, HoldsOverProblems) {
  StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 6);
  const ProblemResult noise =
      analyze_values(plan, {std::vector(6, 1e-14), std::vector(6, 1e-30)}).problems.front();
  const std::vector<ProblemResult> problems(7, noise);
  plan.problems.resize(1);
  std::vector<CellOutcome> cells;
  for (std::size_t p = 0; p < problems.size(); ++p) {
    const auto more = analyze_values(plan, {std::vector(6, 1e-14), std::vector(6, 1e-30)}).cells;
    cells.insert(cells.end(), more.begin(), more.end());
  }
  plan.problems.assign(7, plan.problems.front());
  const OverallResult overall = analyze_overall(plan, problems, cells);
  EXPECT_THAT(overall.ranking.full.mean_ranks, Each(1.5));
  EXPECT_EQ(overall.pairs.front().test.zeros, 7);
  EXPECT_EQ(overall.pairs.front().a12, 0.5);
}

}  // namespace
}  // namespace armwright
