#include "optimizers/interface/scalar_function.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

ProblemDescription make_weighted() {
  ProblemDescription problem;
  problem.objectives = {{"a", ""}, {"b", ""}};
  problem.objective_weights = {2, 0.5};
  problem.constraints = {{"g", ""}, {"h", ""}, {"i", ""}};
  return problem;
}

TEST(Merit, IsTheWeightedSumAndThePenaltyOfWhatIsViolated) {
  const ProblemDescription problem = make_weighted();
  Score score;
  score.objectives = {3, 4};
  score.constraint_values = {0.25, -100, 0.5};  // a constraint that is met earns nothing
  EXPECT_EQ(calc_merit(problem, score, 10), 2 * 3 + 0.5 * 4 + 10 * 0.75);
  EXPECT_EQ(calc_merit(problem, score, 0), 8);
}

TEST(Merit, AViolationWeighsInTheProblemsOwnUnits) {
  ProblemDescription problem = make_weighted();
  problem.violation_scale = 1e6;
  Score score;
  score.objectives = {3, 4};
  score.constraint_values = {0.25, -100, 0.5};
  EXPECT_EQ(calc_merit(problem, score, 2), 8 + 1.5e6);
}

TEST(Merit, OfAFailedEvaluationIsItsPenalty) {
  Score score;
  score.objectives = {1e12, 1e12};
  score.status = EvaluationStatus::diverged;
  EXPECT_EQ(calc_merit(make_weighted(), score, 1000), 2.5e12);
}

TEST(Merit, WithoutWeightsTheFirstObjectiveCounts) {
  ProblemDescription problem = make_weighted();
  problem.objective_weights.clear();
  Score score;
  score.objectives = {3, 4};
  EXPECT_EQ(calc_merit(problem, score, 10), 3);
}

TEST(ScalarFunctionTest, AsksForTheDecisionVectorOfTheCoordinates) {
  const auto problem = make_log_bowl();
  MemoryEvaluator evaluator(*problem, {.budget = 10});
  ScalarFunction function(evaluator);
  const std::vector<double> minimum = {std::log(900), std::log(30), std::log(2)};
  EXPECT_NEAR(function.evaluate(minimum).objectives.at(0), 0, 1e-25);
  function.evaluate(function.space().start());
  EXPECT_THAT(evaluator.trace()[0].asked,
              ElementsAre(testing::DoubleEq(900), testing::DoubleEq(-30), testing::DoubleEq(2)));
  EXPECT_THAT(evaluator.trace()[1].asked, ElementsAre(100, -100, 10));
}

TEST(ScalarFunctionTest, ABatchIsAskedForAsOne) {
  const auto problem = make_log_bowl();
  MemoryEvaluator evaluator(*problem, {.budget = 10});
  ScalarFunction function(evaluator);
  const std::vector<std::vector<double>> points(3, function.space().start());
  EXPECT_EQ(function.evaluate_batch(points).size(), 3u);
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(3));
}

TEST(ScalarFunctionTest, ThrowsUnlessEveryPointGotItsScore) {
  const auto problem = make_log_bowl();
  MemoryEvaluator evaluator(*problem, {.budget = 2});
  ScalarFunction function(evaluator);
  const std::vector<std::vector<double>> points(3, function.space().start());
  EXPECT_THROW(function.evaluate_batch(points), EvaluatorStopped);
  EXPECT_EQ(evaluator.trace().size(), 2u);
  EXPECT_THROW(function.evaluate(points[0]), EvaluatorStopped);
  EXPECT_EQ(evaluator.calls_after_stop(), 1);
}

TEST(ScalarFunctionTest, ExceptionsOfTheEvaluatorComeThrough) {
  const auto problem = make_log_bowl();
  MemoryEvaluator evaluator(*problem, {.budget = 2, .throw_at = 1});
  ScalarFunction function(evaluator);
  EXPECT_THROW(function.evaluate(function.space().start()), BrokenEvaluator);
}

TEST(ScalarFunctionTest, DiscreteVariablesAreRealInItsCoordinatesAndRoundedInItsPoints) {
  const auto problem = make_contract_problems(find_optimizer("random")).back();  // mixed_bowl
  MemoryEvaluator evaluator(*problem, {.budget = 10});
  ScalarFunction function(evaluator);
  EXPECT_THAT(function.space().lower(), ElementsAre(-0.5, -5, -9.5, std::log(0.5)));
  EXPECT_THAT(function.space().upper(), ElementsAre(4.5, 5, 30.5, std::log(2000.5)));
  function.evaluate(function.space().upper());
  function.evaluate(std::vector<double>{1.4, 0.25, -3.6, std::log(17.3)});
  EXPECT_THAT(evaluator.trace()[0].asked, ElementsAre(4, 5, 30, 2000));
  EXPECT_THAT(evaluator.trace()[1].asked, ElementsAre(1, 0.25, -4, 17));
}

}  // namespace
}  // namespace armwright
