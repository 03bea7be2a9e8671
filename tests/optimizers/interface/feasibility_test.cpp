#include "optimizers/interface/feasibility.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace armwright {
namespace {

using testing::ElementsAre;

ProblemDescription describe(std::size_t constraints) {
  ProblemDescription problem;
  problem.constraints.resize(constraints);
  return problem;
}

TEST(Feasibility, SeveralObjectivesCountAsTheirWeightedSum) {
  ProblemDescription problem;
  problem.objective_weights = {2, 10};
  const Score score{.objectives = {3, 7}, .constraint_values = {}, .residuals = {}, .jacobian = {}};
  EXPECT_EQ(calc_fitness(problem, score).objective, 76);
}

TEST(Feasibility, AddsUpViolationsAndKnowsWhatItIsNotTold) {
  const Score met{
      .objectives = {3, 7}, .constraint_values = {-1, 0}, .residuals = {}, .jacobian = {}};
  EXPECT_EQ(calc_fitness(describe(2), met).violation, 0);
  EXPECT_EQ(calc_fitness(describe(2), met).objective, 3);
  const Score violated{
      .objectives = {3}, .constraint_values = {2, -5, 0.5}, .residuals = {}, .jacobian = {}};
  EXPECT_EQ(calc_fitness(describe(3), violated).violation, 2.5);
  const Score failed{
      .objectives = {1e12}, .constraint_values = {}, .residuals = {}, .jacobian = {}};
  EXPECT_EQ(calc_fitness(describe(1), failed).violation, std::numeric_limits<double>::infinity());
  EXPECT_EQ(calc_fitness(describe(0), failed).violation, 0);
}

TEST(Feasibility, FeasibilityComesFirst) {
  const Fitness good{0, 1};
  const Fitness poor{0, 100};
  const Fitness nearly{0.1, -5};
  const Fitness far{2, -50};
  const Fitness far_and_worse{2, -40};
  EXPECT_TRUE(is_fitter(good, poor));
  EXPECT_FALSE(is_fitter(poor, good));
  EXPECT_TRUE(is_fitter(poor, nearly));
  EXPECT_TRUE(is_fitter(nearly, far));
  EXPECT_FALSE(is_fitter(far, nearly));
  EXPECT_TRUE(is_fitter(far, far_and_worse));
  EXPECT_FALSE(is_fitter(good, good));
}

Score make_score(double objective, std::vector<double> constraint_values) {
  return {.objectives = {objective},
          .constraint_values = std::move(constraint_values),
          .residuals = {},
          .jacobian = {}};
}

TEST(FeasibilityOrderTest, WithoutConstraintsTheObjectiveIsTheNumber) {
  const ProblemDescription problem = describe(0);
  FeasibilityOrder order(problem);
  EXPECT_THAT(order.rate(std::vector{make_score(3, {}), make_score(-1e12, {})}),
              ElementsAre(3, -1e12));
}

TEST(FeasibilityOrderTest, WhatViolatesIsWorseThanAnythingSeenThatDoesNot) {
  ProblemDescription problem = describe(2);
  problem.violation_scale = 8;
  FeasibilityOrder order(problem);
  // The largest objective is 7, of a point that violates a constraint itself.
  EXPECT_THAT(order.rate(std::vector{make_score(5, {-1, 0}), make_score(-9, {0.25, -3}),
                                     make_score(7, {0.5, 1}), make_score(6, {0, 0})}),
              ElementsAre(5, 7 + 8 * 0.25, 7 + 8 * 1.5, 6));
  // The level stays where it is: the same points have the same numbers in the next generation.
  EXPECT_THAT(order.rate(std::vector{make_score(1, {0.25, -3}), make_score(2, {-1, -1})}),
              ElementsAre(7 + 8 * 0.25, 2));
}

TEST(FeasibilityOrderTest, OrdersAsIsFitterDoes) {
  const ProblemDescription problem = describe(1);
  std::vector<Score> scores;
  for (const double objective : {-3.0, 0.0, 2.0, 1e6}) {
    for (const double g : {-1.0, 0.0, 0.125, 1e4}) {
      scores.push_back(make_score(objective, {g}));
    }
  }
  scores.push_back(make_score(1e9, {}));  // failed
  FeasibilityOrder order(problem);
  const std::vector<double> values = order.rate(scores);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    EXPECT_TRUE(std::isfinite(values[i]));
    for (std::size_t k = 0; k < scores.size(); ++k) {
      const Fitness a = calc_fitness(problem, scores[i]);
      const Fitness b = calc_fitness(problem, scores[k]);
      const bool is_tie = a.violation == b.violation && a.violation > 0;
      EXPECT_EQ(values[i] < values[k], is_fitter(a, b) && !is_tie) << i << " and " << k;
    }
  }
}

TEST(FeasibilityOrderTest, FailuresAloneHaveANumber) {
  const ProblemDescription problem = describe(1);
  FeasibilityOrder order(problem);
  const std::vector<double> values = order.rate(std::vector{make_score(1e300, {})});
  EXPECT_TRUE(std::isfinite(values.at(0)));
  // It does not make the level: a point that violates a constraint stays well below.
  EXPECT_THAT(order.rate(std::vector{make_score(4, {1})}), ElementsAre(5));
}

}  // namespace
}  // namespace armwright
