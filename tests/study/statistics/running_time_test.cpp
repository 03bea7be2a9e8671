#include "study/statistics/running_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "study/statistics/support.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;
using Table = std::vector<std::vector<double>>;

TEST(CostToTarget, IsTheFirstCostThatReachesIt) {
  const std::vector<TracePoint> trace = {{1, kInf}, {3, 10}, {8, 2}, {20, -1}};
  EXPECT_EQ(calc_cost_to_target(trace, 10), 3);
  EXPECT_EQ(calc_cost_to_target(trace, 9), 8);
  EXPECT_EQ(calc_cost_to_target(trace, -1), 20);
  EXPECT_EQ(calc_cost_to_target(trace, -2), kInf);
  EXPECT_EQ(calc_cost_to_target(trace, kInf), 3);  // a trace point without value reaches no target
  EXPECT_EQ(calc_cost_to_target(trace, -kInf), kInf);
  EXPECT_EQ(calc_cost_to_target({}, 5), kInf);
}

TEST(CostToTarget, RefusesWhatIsNoTrace) {
  using Trace = std::vector<TracePoint>;
  EXPECT_THAT([] { calc_cost_to_target(Trace{{5, 1}, {4, 0}}, 0); }, refuses("a cost is 4"));
  EXPECT_THAT([] { calc_cost_to_target(Trace{{-1, 1}}, 0); }, refuses("a cost is -1"));
  EXPECT_THAT([] { calc_cost_to_target(Trace{{1, kNan}}, 0); }, refuses("nan"));
  EXPECT_THAT([] { calc_cost_to_target({}, kNan); }, refuses("the target is NaN"));
}

TEST(ExpectedRunningTime, ChargesFailuresToTheSuccesses) {
  const std::vector<Trial> trials = {{10, true}, {100, false}, {30, true}, {100, false}};
  EXPECT_EQ(calc_expected_running_time(trials), 120);
  EXPECT_EQ(calc_expected_running_time(std::vector<Trial>{{10, true}, {30, true}}), 20);
  EXPECT_EQ(calc_expected_running_time(std::vector<Trial>{{100, false}}), kInf);
  EXPECT_EQ(calc_expected_running_time(std::vector<Trial>{{0, false}}), kInf);
}

TEST(ExpectedRunningTime, IntervalHoldsItAndShrinksWithMoreTrials) {
  std::vector<Trial> trials = {{10, true}, {100, false}, {30, true}, {100, false}, {25, true}};
  const Interval few = calc_resampled_running_time_interval(trials, 0.95, 2000, "few");
  for (int i = 0; i < 4; ++i) {
    trials.insert(trials.end(), trials.begin(), trials.begin() + 5);
  }
  const Interval many = calc_resampled_running_time_interval(trials, 0.95, 2000, "many");
  const double expected = calc_expected_running_time(trials);
  EXPECT_LT(few.lower, many.lower);
  EXPECT_LT(many.lower, expected);
  EXPECT_LT(expected, many.upper);
  EXPECT_LT(many.upper, few.upper);
}

TEST(ExpectedRunningTime, OfFailuresAloneIsInfinite) {
  const std::vector<Trial> failures(3, {100, false});
  const Interval interval = calc_resampled_running_time_interval(failures, 0.95, 10, "s");
  EXPECT_EQ(interval.lower, kInf);
  EXPECT_EQ(interval.upper, kInf);
}

TEST(ExpectedRunningTime, RefusesWhatIsNoTrial) {
  using Trials = std::vector<Trial>;
  EXPECT_THAT([] { calc_expected_running_time({}); }, refuses("no trials"));
  EXPECT_THAT([] { calc_expected_running_time(Trials{{-1, true}}); }, refuses("is -1"));
  EXPECT_THAT([] { calc_expected_running_time(Trials{{kInf, false}}); }, refuses("is inf"));
  EXPECT_THAT([] { calc_expected_running_time(Trials{{kNan, true}}); }, refuses("is nan"));
  EXPECT_THAT(
      [] {
        calc_resampled_running_time_interval(Trials{{1, true}}, 0.9, 0, "s");
      },
      refuses("at least one"));
}

// Two trials have four equally likely resamples: twice the success (10), one of each (10 + 30) in
// two orders, and twice the failure (infinite).
TEST(ResampledRunningTime, IsThatOfTheTrialsDrawnAnew) {
  const std::vector<Trial> trials = {{10, true}, {30, false}};
  EXPECT_EQ(calc_expected_running_time(trials), 40);
  const Interval wide = calc_resampled_running_time_interval(trials, 0.95, 2000, "s");
  EXPECT_EQ(wide.lower, 10);
  EXPECT_EQ(wide.upper, kInf);
  const Interval narrow = calc_resampled_running_time_interval(trials, 0.4, 2000, "s");
  EXPECT_EQ(narrow.lower, 40);
  EXPECT_EQ(narrow.upper, 40);
  const std::vector<Trial> failures(3, {100, false});
  EXPECT_EQ(calc_resampled_running_time_interval(failures, 0.95, 10, "s").lower, kInf);
  EXPECT_THAT([] { calc_resampled_running_time_interval({}, 0.95, 10, "s"); },
              refuses("no trials"));
}

TEST(RunningTimeRatio, DrawsPairsTogether) {
  const std::vector<Trial> trials = {{10, true}, {30, true}};
  const std::vector<Trial> reference = {{100, true}, {300, true}};
  const RunningTimeRatio same = calc_running_time_ratio(trials, reference, 0.95, 2000, "s");
  EXPECT_DOUBLE_EQ(*same.ratio, 0.1);  // in every resample, because each pair has it
  EXPECT_DOUBLE_EQ(same.interval.lower, 0.1);
  EXPECT_DOUBLE_EQ(same.interval.upper, 0.1);
}

// The second trial of the reference fails. Resamples: twice the first pair, 10 / 100; one of each
// in two orders, 20 / 400; twice the second pair, 30 / infinite.
TEST(RunningTimeRatio, OfAReferenceThatFailsSometimes) {
  const std::vector<Trial> trials = {{10, true}, {30, true}};
  const std::vector<Trial> reference = {{100, true}, {300, false}};
  const RunningTimeRatio ratio = calc_running_time_ratio(trials, reference, 0.95, 2000, "s");
  EXPECT_DOUBLE_EQ(*ratio.ratio, 20.0 / 400);
  EXPECT_EQ(ratio.interval.lower, 0);
  EXPECT_DOUBLE_EQ(ratio.interval.upper, 0.1);
}

TEST(RunningTimeRatio, OfTwoThatNeverSucceedIsUnknown) {
  const std::vector<Trial> failures(2, {100, false});
  const RunningTimeRatio ratio = calc_running_time_ratio(failures, failures, 0.95, 10, "s");
  EXPECT_FALSE(ratio.ratio);
  EXPECT_EQ(ratio.interval.lower, 0);
  EXPECT_EQ(ratio.interval.upper, kInf);
  const std::vector<Trial> one = {{1, true}};
  EXPECT_THAT([&] { calc_running_time_ratio(one, failures, 0.95, 10, "s"); },
              refuses("a ratio needs pairs of trials"));
}

TEST(RuntimeEcdf, CountsWhatIsReachedWithinACost) {
  const std::vector times = {5.0, kInf, 1.0, 5.0};
  EXPECT_THAT(calc_runtime_ecdf(times, std::vector{0.5, 1.0, 4.9, 5.0, kInf}),
              ElementsAre(0, 0.25, 0.25, 0.75, 0.75));
  EXPECT_THAT([] { calc_runtime_ecdf({}, std::vector{1.0}); }, refuses("there are none"));
  EXPECT_THAT([] { calc_runtime_ecdf(std::vector{-1.0}, {}); }, refuses("a running time is -1"));
}

TEST(AnytimeArea, WeighsOrdersOfMagnitudeAlike) {
  EXPECT_EQ(calc_anytime_area(std::vector{0.0, 1.0}, 1, 100), 1);
  EXPECT_EQ(calc_anytime_area(std::vector{kInf, 100.0, 101.0}, 1, 100), 0);
  EXPECT_DOUBLE_EQ(calc_anytime_area(std::vector{10.0}, 1, 100), 0.5);
  EXPECT_DOUBLE_EQ(calc_anytime_area(std::vector{1.0, kInf, 10.0, 100.0}, 1, 100), 0.375);
}

TEST(AnytimeArea, IsTheMeanOfTheEcdfOverLogarithmicCosts) {
  const std::vector times = {3.0, 17.0, 17.0, 230.0, 900.0, 5000.0, kInf};
  constexpr int kCosts = 20000;
  std::vector<double> costs;
  for (int i = 0; i < kCosts; ++i) {
    costs.push_back(std::pow(10.0, 3 * (i + 0.5) / kCosts));
  }
  const std::vector<double> shares = calc_runtime_ecdf(times, costs);
  const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / kCosts;
  // Each step is off by at most half a spacing.
  EXPECT_NEAR(calc_anytime_area(times, 1, 1000), mean, 0.5 / kCosts);
  EXPECT_THAT([&] { calc_anytime_area(times, 0, 10); }, refuses("0 < lowest"));
  EXPECT_THAT([&] { calc_anytime_area(times, 10, 10); }, refuses("lowest < highest"));
  EXPECT_THAT([&] { calc_anytime_area(times, 1, kInf); }, refuses("highest < infinity"));
  EXPECT_THAT([] { calc_anytime_area({}, 1, 10); }, refuses("there are none"));
}

TEST(Profiles, ConvergenceIsAShareOfTheWayFromTheStart) {
  EXPECT_EQ(calc_convergence_target(10, 2, 0.25), 4);
  EXPECT_EQ(calc_convergence_target(10, 2, 0), 2);
  EXPECT_EQ(calc_convergence_target(7, 7, 0.1), 7);
  EXPECT_EQ(calc_convergence_target(7, 9, 0.1), 7);
  EXPECT_EQ(calc_convergence_target(7, kInf, 0.1), 7);
  EXPECT_THAT([] { calc_convergence_target(7, 6, -0.1); }, refuses("tau is -0.1"));
  EXPECT_THAT([] { calc_convergence_target(kNan, 6, 0.1); }, refuses("the start's value"));
  EXPECT_THAT([] { calc_convergence_target(7, kNan, 0.1); }, refuses("the best value"));
}

TEST(Profiles, OfAFailedStartAnyNumberConverges) {
  const double target = calc_convergence_target(kInf, 3, 0);
  EXPECT_EQ(calc_cost_to_target(std::vector<TracePoint>{{1, kInf}, {2, 1e300}}, target), 2);
  const double nobody = calc_convergence_target(kInf, kInf, 0.1);
  EXPECT_EQ(calc_cost_to_target(std::vector<TracePoint>{{1, kInf}}, nobody), kInf);
}

TEST(Profiles, PerformanceIsRelativeToTheBestOnEachProblem) {
  const std::vector<std::vector<double>> costs = {{10, 20}, {30, 15}, {7, 7}, {kInf, kInf}};
  // One solver is best on three of four problems, including ties. The problem without a solution
  // counts.
  EXPECT_THAT(
      calc_performance_profiles(costs, std::vector{0.9, 1.0, 1.9, 2.0, kInf}),
      ElementsAre(ElementsAre(0, 0.5, 0.5, 0.75, 0.75), ElementsAre(0, 0.5, 0.5, 0.75, 0.75)));
  const std::vector<std::vector<double>> alone = {{5, kInf, 0}, {5, kInf, 4}};
  EXPECT_THAT(calc_performance_profiles(alone, std::vector{1.0, 1.25, kInf}),
              ElementsAre(ElementsAre(0, 0.5, 0.5), Each(0), Each(1)));
}

TEST(Profiles, DataIsInSimplexGradients) {
  const std::vector<std::vector<double>> costs = {{10, kInf}, {30, 12}};
  const std::vector dimensions = {4, 2};  // units of 5 and 3: 2, never; 10, 4
  EXPECT_THAT(calc_data_profiles(costs, dimensions, std::vector{1.9, 2.0, 4.0, 10.0, kInf}),
              ElementsAre(ElementsAre(0, 0.5, 0.5, 1, 1), ElementsAre(0, 0, 0.5, 0.5, 0.5)));
}

TEST(Profiles, RefuseWhatIsNoTableOfCosts) {
  const std::vector one = {1.0};
  EXPECT_THAT([&] { calc_performance_profiles({}, one); }, refuses("no numbers"));
  EXPECT_THAT([&] { calc_performance_profiles(Table{{1, 2}, {1}}, one); }, refuses("another 1"));
  EXPECT_THAT([&] { calc_performance_profiles(Table{{-1}}, one); }, refuses("a cost is -1"));
  EXPECT_THAT([&] { calc_data_profiles(Table{{1}}, {}, one); }, refuses("its dimension"));
  EXPECT_THAT([&] { calc_data_profiles(Table{{1}}, std::vector{0}, one); }, refuses("is 0"));
}

}  // namespace
}  // namespace armwright
