#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "report/formats/formats.hpp"
#include "report/hand_made_traces.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

TEST(CocoLevel, IsTheLeastThatIsNotBelowTheDifference) {
  EXPECT_EQ(calc_coco_level(1), 0);    // 10^(0/20)
  EXPECT_EQ(calc_coco_level(0.9), 0);  // 10^(-1/20) is 0.891...
  EXPECT_EQ(calc_coco_level(0.89), -1);
  EXPECT_EQ(calc_coco_level(0.5), -6);
  EXPECT_EQ(calc_coco_level(0.45), -6);  // above 10^(-7/20), 0.4467
  EXPECT_EQ(calc_coco_level(0.44), -7);
}

TEST(CocoLevel, EndsAtThePrecision) {
  EXPECT_GT(calc_coco_level(2e-8), calc_coco_level(1e-8));
  EXPECT_EQ(calc_coco_level(1e-9), calc_coco_level(1e-8));
  EXPECT_EQ(calc_coco_level(0), calc_coco_level(1e-8));
}

TEST(CocoMilestone, IsThePowersOfTenByTwentiethsAndMultiplesOfTheDimension) {
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t i = 1; i <= 65; ++i) {
    if (is_coco_milestone(i, 3)) {
      numbers.push_back(i);
    }
  }
  // 10^(k/20): 1 1.1 1.3 1.4 1.6 1.8 2.0 2.2 2.5 2.8 3.2 3.5 4.0 4.5 5.0 5.6 6.3 7.1 7.9 8.9
  // 10 11.2 12.6 14.1 15.8 17.8 20.0 22.4 25.1 28.2 31.6 35.5 39.8 44.7 50.1 56.2 63.1; 15, 30 and
  // 60 are multiples of 3 only.
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 14, 15, 17, 19, 22, 25, 28,
                                   30, 31, 35, 39, 44, 50, 56, 60, 63));
}

TEST(CocoMilestone, MeetsTheWholePowersAndGapsInBetween) {
  EXPECT_TRUE(is_coco_milestone(100, 7));
  EXPECT_FALSE(is_coco_milestone(101, 7));
  EXPECT_TRUE(is_coco_milestone(1000, 7));
  EXPECT_TRUE(is_coco_milestone(7000, 7));
  EXPECT_FALSE(is_coco_milestone(9000, 7));
  EXPECT_TRUE(is_coco_milestone(1000000, 7));
  EXPECT_TRUE(is_coco_milestone(3500000, 7));
}

TEST(ConstraintDigits, GrowWithTheViolation) {
  const std::vector<double> values = {
      -1,   0,    1e-9, 1e-7, 1.1e-7, 1e-6, 1e-5,
      1e-4, 1e-3, 1e-2, 1e-1, 1,      1.1,  std::numeric_limits<double>::infinity()};
  EXPECT_EQ(format_constraint_digits(values), "00112234567899");
  EXPECT_EQ(format_constraint_digits({}), "");
}

ProblemRuns make_problem(double best, std::size_t constraints = 0) {
  ProblemRuns problem;
  problem.best = best;
  problem.worst = best;
  problem.constraints = constraints;
  return problem;
}

TEST(CocoRun, HasARowPerLevelAndARowPerMilestone) {
  const CocoRun run = make_coco_run(make_trace({101.0, 102.0, 2.0, 1.99, 1.5, 1.0, 4.0, 4.0, 5.0}),
                                    make_problem(1));
  EXPECT_EQ(run.header,
            "% f evaluations | g evaluations | best noise-free fitness - Fref (1.000000000000e+00) "
            "+ sum g_i+ | measured fitness | best measured fitness or single-digit g-values | x1 | "
            "x2...\n");
  EXPECT_EQ(run.dat,
            "1 0 +1.000000000e+02 +1.010000000e+02 +1.010000000e+02 +5.0000e-01\n"
            "3 0 +1.000000000e+00 +2.000000000e+00 +2.000000000e+00 +5.0000e-01\n"
            "5 0 +5.000000000e-01 +1.500000000e+00 +1.500000000e+00 +5.0000e-01\n"
            "6 0 +0.000000000e+00 +1.000000000e+00 +1.000000000e+00 +5.0000e-01\n"
            "9 0 +0.000000000e+00 +5.000000000e+00 +1.000000000e+00 +5.0000e-01\n");
  EXPECT_EQ(run.tdat,
            "1 0 +1.000000000e+02 +1.010000000e+02 +1.010000000e+02 +5.0000e-01\n"
            "2 0 +1.000000000e+02 +1.020000000e+02 +1.010000000e+02 +5.0000e-01\n"
            "3 0 +1.000000000e+00 +2.000000000e+00 +2.000000000e+00 +5.0000e-01\n"
            "4 0 +9.900000000e-01 +1.990000000e+00 +1.990000000e+00 +5.0000e-01\n"
            "5 0 +5.000000000e-01 +1.500000000e+00 +1.500000000e+00 +5.0000e-01\n"
            "6 0 +0.000000000e+00 +1.000000000e+00 +1.000000000e+00 +5.0000e-01\n"
            "7 0 +0.000000000e+00 +4.000000000e+00 +1.000000000e+00 +5.0000e-01\n"
            "8 0 +0.000000000e+00 +4.000000000e+00 +1.000000000e+00 +5.0000e-01\n"
            "9 0 +0.000000000e+00 +5.000000000e+00 +1.000000000e+00 +5.0000e-01\n");
  EXPECT_EQ(run.summary, "3:9|0.0e+00");
}

TEST(CocoRun, CountsNoConstraintsAndShowsThemAsDigits) {
  const RunTrace trace =
      make_trace({5.0, 2.0, std::nullopt}, [](std::vector<TracedEvaluation>& evaluations) {
        evaluations[0].constraint_values = {0.5, -1};
        evaluations[0].feasible = false;
        evaluations[1].constraint_values = {0, -2};
      });
  const CocoRun run = make_coco_run(trace, make_problem(1.5, 2));
  EXPECT_EQ(run.dat,
            "1 0 +9.999999998e+09 +1.000000000e+10 80 +5.0000e-01\n"
            "2 0 +5.000000000e-01 +2.000000000e+00 00 +5.0000e-01\n"
            "3 0 +5.000000000e-01 +1.000000000e+10 99 +5.0000e-01\n");
  EXPECT_EQ(run.summary, "3:3|5.0e-01");
}

TEST(CocoRun, MeasuresFromAKnownOptimumHoweverFarTheBestRunIsFromIt) {
  RunTrace trace = make_trace({500.0, 116.0});
  trace.function.optimum = 100;
  const CocoRun run = make_coco_run(trace, make_problem(116));
  EXPECT_THAT(run.header, testing::HasSubstr("fitness - Fopt (1.000000000000e+02) +"));
  EXPECT_EQ(run.dat,
            "1 0 +4.000000000e+02 +5.000000000e+02 +5.000000000e+02 +5.0000e-01\n"
            "2 0 +1.600000000e+01 +1.160000000e+02 +1.160000000e+02 +5.0000e-01\n");
  EXPECT_EQ(run.summary, "3:2|1.6e+01");
}

TEST(CocoRun, IsNeverBelowAKnownOptimum) {
  RunTrace trace = make_trace({-44.0000001});
  trace.function.optimum = -44;
  EXPECT_EQ(make_coco_run(trace, make_problem(-44.0000001)).summary, "3:1|0.0e+00");
}

TEST(CocoRun, ShowsUpToSixVariables) {
  const auto make = [](std::size_t variables) {
    RunTrace trace = make_trace({2.0}, [&](std::vector<TracedEvaluation>& evaluations) {
      evaluations[0].x.assign(variables, -0.25);
    });
    trace.names.variables.assign(variables, "x");
    return trace;
  };
  EXPECT_THAT(make_coco_run(make(6), {}).dat,
              testing::EndsWith(" +2.000000000e+00 -2.5000e-01 -2.5000e-01 -2.5000e-01 -2.5000e-01 "
                                "-2.5000e-01 -2.5000e-01\n"));
  EXPECT_THAT(make_coco_run(make(7), {}).dat, testing::EndsWith(" +2.000000000e+00\n"));
}

TEST(CocoInfeasible, IsAboveAllFeasibleObjectives) {
  ProblemRuns problem;
  EXPECT_EQ(calc_coco_infeasible(problem), 1e10);
  problem.best = -2;
  problem.worst = 3e11;
  EXPECT_EQ(calc_coco_infeasible(problem), 1e12);
}

}  // namespace
}  // namespace armwright
