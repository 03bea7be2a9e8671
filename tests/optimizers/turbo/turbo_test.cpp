// Whole runs of turbo.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/expect_error.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/test_problems.hpp"
#include "optimizers/turbo/turbo_box.hpp"
#include "problems/analytic/analytic.hpp"
#include "sample_or_all.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {
namespace {

// The median of five seeds, in the quick check of three, of what is left to the optimum.
double calc_median_gap(const Problem& problem, std::int64_t budget,
                       const std::vector<std::string>& options = {}) {
  std::vector<double> gaps;
  for (std::uint64_t seed = 1; seed <= sample_or_all<std::uint64_t>(3, 5); ++seed) {
    gaps.push_back(
        run_optimizer("turbo", problem, {.budget = budget}, seed, options).best().value_or(1e300) -
        problem.description().optimum.value_or(0));
  }
  std::ranges::sort(gaps);
  return gaps[gaps.size() / 2];
}

TEST(Turbo, ConvergesOnBraninInSixtyEvaluations) {
  EXPECT_LT(calc_median_gap(*make_analytic("branin"), 60), 1e-3);
}

TEST(Turbo, ConvergesOnTheSphereInTenVariablesInAHundredEvaluations) {
  EXPECT_LT(calc_median_gap(*make_analytic("sphere"), 100), 0.01);  // random search: about 20
}

TEST(Turbo, BatchesOfFourConvergeToo) {
  EXPECT_LT(calc_median_gap(*make_analytic("branin"), 80, {"batch=4"}), 1e-3);
  const MemoryEvaluator evaluator =
      run_optimizer("turbo", *make_analytic("branin"), {.budget = 33}, 1, {"batch=4"});
  EXPECT_THAT(evaluator.batch_sizes(), testing::ElementsAre(5, 4, 4, 4, 4, 4, 4, 4));
}

TEST(Turbo, FollowsConstraintsToTheirCorner) {
  EXPECT_LT(calc_median_gap(*make_analytic("constrained"), 100), 0.5);
}

TEST(Turbo, BeginsWithTheStartAndALatinHypercube) {
  const auto problem = make_analytic("sphere", 3);
  const MemoryEvaluator evaluator = run_optimizer("turbo", *problem, {.budget = 6});
  EXPECT_EQ(evaluator.trace()[0].evaluated, list_starts(problem->description().variables));
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<int> fifths;
    for (std::size_t k = 1; k < 6; ++k) {
      fifths.push_back(static_cast<int>(std::floor(evaluator.trace()[k].evaluated[i] / 2 + 2.5)));
    }
    EXPECT_THAT(fifths, testing::UnorderedElementsAre(0, 1, 2, 3, 4)) << "variable " << i;
  }
}

TEST(Turbo, FindsTheWordAndTheWholeNumbers) {
  std::vector<DecisionVariable> variables = {
      {"oil", "", 0, 3, 0, Scale::linear, VariableType::category, {"a", "b", "c", "d"}},
      {"teeth", "", 1, 1000, 10, Scale::logarithmic, VariableType::integer},
      {"gain", "", 0, 1, 0.9, Scale::linear}};
  const FunctionProblem problem(variables, [](std::span<const double> x, std::uint64_t) {
    return (x[0] == 2 ? 0.0 : 1 + x[0]) + std::pow(std::log(x[1] / 90), 2) +
           std::pow(x[2] - 0.3, 2);
  });
  // The best word, and 90 teeth within one step of rounding.
  EXPECT_LT(calc_median_gap(problem, 60), 1e-3);
}

TEST(Turbo, APenaltyDoesNotHideTheShapeOfTheRest) {
  const auto problem = make_analytic("branin");
  const MemoryEvaluator evaluator =
      run_optimizer("turbo", *problem, {.budget = 90, .fail_every = 4});
  // Every fourth evaluation fails, also the good ones. Values above the optimum are up to 300.
  EXPECT_LT(evaluator.best().value_or(1e300) - *problem->description().optimum, 0.2);
}

TEST(Turbo, GoesOnWhereEveryPointIsKnown) {
  const std::vector<DecisionVariable> variables = {
      {"n", "", 0, 4, 0, Scale::linear, VariableType::integer}};
  const FunctionProblem problem(
      variables, [](std::span<const double> x, std::uint64_t) { return std::abs(x[0] - 3); });
  const MemoryEvaluator evaluator = run_optimizer("turbo", problem, {.budget = 60});
  EXPECT_EQ(evaluator.best(), 0.0);
  EXPECT_EQ(evaluator.trace().size(), 60);
}

TEST(Turbo, MoreVariablesOrEvaluationsThanItIsMadeForAreRefused) {
  const OptimizerRow& row = find_optimizer("turbo");
  EXPECT_EQ(explain_unsuitable(row, make_analytic("sphere", 41)->description()),
            "it is made for at most 40 decision variables, and this one has 41; use cmaes");
  EXPECT_EQ(explain_unsuitable(row, make_analytic("sphere", 40)->description()), "");
  RunPlan plan;
  plan.problem.problem = make_analytic("sphere");
  plan.problem.name = "sphere";
  plan.optimizer = row;
  plan.options = Options::parse("turbo", row.options, {});
  plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 3};
  plan.budget = 6000;
  check_plan(plan);
  plan.budget = 6003;
  EXPECT_EQ(usage_error_of([&] { check_plan(plan); }),
            "optimizer 'turbo' is made for at most 2000 evaluations, and a budget of 6003 with "
            "schedule fixed:3 has 2001; use --budget 6000, or --optimizer cmaes");
}

TEST(TurboBox, EveryValueOfADiscreteVariableHasOnePlace) {
  const std::vector<DecisionVariable> variables = {
      {"word", "", 0, 2, 1, Scale::linear, VariableType::category, {"a", "b", "c"}},
      {"count", "", 1, 20, 4, Scale::logarithmic, VariableType::integer},
      {"gain", "", -100, -1, -10, Scale::logarithmic}};
  const TurboBox box(variables);
  EXPECT_EQ(box.to_point(box.start()), list_starts(variables));
  for (const double word : {0.0, 1.0, 2.0}) {
    for (double count = 1; count <= 20; ++count) {
      Eigen::VectorXd u(3);
      u << (word + 0.3) / 3, (std::log(count + 0.2) - std::log(0.5)) / std::log(20.5 / 0.5), 0.5;
      box.settle(u);
      EXPECT_EQ(box.to_point(u)[0], word);
      EXPECT_EQ(box.to_point(u)[1], count);
      EXPECT_NEAR(box.to_point(u)[2], -10, 1e-12);
      const Eigen::VectorXd once = u;
      box.settle(u);
      EXPECT_LT((u - once).norm(), 1e-14) << "settling twice moves it";
      const Eigen::VectorXd features = box.calc_features(u);
      ASSERT_EQ(features.size(), 5);
      for (Eigen::Index k = 0; k < 3; ++k) {
        EXPECT_EQ(features[k] > 0, k == static_cast<Eigen::Index>(word));
      }
      // From the least width around a count, both neighbours can be reached.
      const double half = box.calc_least_width(1, u[1]) / 2;
      for (const double side : {-1.0, 1.0}) {
        Eigen::VectorXd next = u;
        next[1] += side * half;
        box.settle(next);
        const double neighbour = std::clamp(count + side, 1.0, 20.0);
        EXPECT_GE(side * (box.to_point(next)[1] - neighbour), 0) << count << ' ' << side;
      }
    }
  }
}

}  // namespace
}  // namespace armwright
