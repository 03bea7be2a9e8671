#include "optimizers/interface/differences.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

// x^3 + 10 y on the box (0, 2) x (0, 10).
std::unique_ptr<Problem> make_cubic() {
  return std::make_unique<FunctionProblem>(
      std::vector<DecisionVariable>{{"x", "", 0, 2, 1, Scale::linear},
                                    {"y", "", 0, 10, 5, Scale::linear}},
      [](std::span<const double> x, std::uint64_t) { return x[0] * x[0] * x[0] + 10 * x[1]; });
}

std::vector<double> take_value(const Score& score) {
  return score.status == EvaluationStatus::ok ? score.objectives : std::vector<double>{};
}

struct Look {
  DifferencedFunction::Place place;
  std::vector<std::size_t> batch_sizes;
};

Look look(const std::vector<double>& at, bool central, std::int64_t fail_every = 0) {
  const auto problem = make_cubic();
  MemoryEvaluator evaluator(*problem, {.budget = 100, .fail_every = fail_every});
  DifferencedFunction function(evaluator, take_value, {.central = central, .step = 0.05});
  const DifferencedFunction::Place place = function.evaluate_place(at, true);
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    EXPECT_FALSE(entry.score.clipped);
  }
  return {place, evaluator.batch_sizes()};
}

// Slopes of the chords of x^3 by hand, h = 0.1; rounding eps / h.
TEST(Differences, ForwardAndCentralAreTheChordsTheySay) {
  const Look forward = look({1, 5}, false);
  EXPECT_THAT(forward.place.values, ElementsAre(51));
  EXPECT_THAT(forward.place.derivatives, ElementsAre(ElementsAre(DoubleNear(3.31, 1e-12)),
                                                     ElementsAre(DoubleNear(10, 1e-12))));
  EXPECT_THAT(forward.batch_sizes, ElementsAre(3));
  const Look central = look({1, 5}, true);
  EXPECT_THAT(central.place.derivatives, ElementsAre(ElementsAre(DoubleNear(3.01, 1e-12)),
                                                     ElementsAre(DoubleNear(10, 1e-12))));
  EXPECT_THAT(central.batch_sizes, ElementsAre(5));
}

TEST(Differences, AtABoundTheShiftGoesInward) {
  const Look forward = look({2, 10}, false);
  EXPECT_THAT(forward.place.derivatives, ElementsAre(ElementsAre(DoubleNear(11.41, 1e-12)),
                                                     ElementsAre(DoubleNear(10, 1e-12))));
  EXPECT_THAT(forward.batch_sizes, ElementsAre(3));
  const Look central = look({0, 10}, true);  // one side each
  EXPECT_THAT(central.place.derivatives, ElementsAre(ElementsAre(DoubleNear(0.01, 1e-12)),
                                                     ElementsAre(DoubleNear(10, 1e-12))));
  EXPECT_THAT(central.batch_sizes, ElementsAre(3));
}

TEST(Differences, AFailedShiftLeavesNoSlopeOrTheOtherSide) {
  EXPECT_THAT(look({1, 5}, false, 2).place.derivatives,
              ElementsAre(ElementsAre(0), ElementsAre(DoubleNear(10, 1e-12))));
  // The second and the fourth of five: x + h and y + h.
  EXPECT_THAT(
      look({1, 5}, true, 2).place.derivatives,
      ElementsAre(ElementsAre(DoubleNear(2.71, 1e-12)), ElementsAre(DoubleNear(10, 1e-12))));
  const Look failed = look({1, 5}, false, 1);
  EXPECT_THAT(failed.place.values, IsEmpty());
  EXPECT_THAT(failed.place.derivatives, IsEmpty());
}

TEST(Differences, NoPlaceIsAskedForTwice) {
  const auto problem = make_cubic();
  MemoryEvaluator evaluator(*problem, {.budget = 100});
  DifferencedFunction function(evaluator, take_value, {.central = false, .step = 0.05});
  for (const bool with_derivatives : {false, false, true, true, false}) {
    function.evaluate_place({1, 5}, with_derivatives);
    function.evaluate_place({1, 6}, false);
  }
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(1, 1, 2));
}

TEST(Differences, TheEndOfTheBudgetComesOut) {
  const auto problem = make_cubic();
  MemoryEvaluator evaluator(*problem, {.budget = 2});
  DifferencedFunction function(evaluator, take_value, {.central = false, .step = 0.05});
  EXPECT_THROW(function.evaluate_place({1, 5}, true), EvaluatorStopped);
  EXPECT_EQ(evaluator.trace().size(), 2u);
}

// Residuals u v and v^2 of two logarithmic variables of either sign and a linear one.
std::unique_ptr<Problem> make_products() {
  return std::make_unique<JacobianProblem>(
      std::vector<DecisionVariable>{{"u", "", 1, 100, 5, Scale::logarithmic},
                                    {"v", "", -100, -1, -5, Scale::logarithmic},
                                    {"w", "", -1, 1, 0.5, Scale::linear}},
      [](std::span<const double> x) {
        return std::vector<double>{x[0] * x[1], x[1] * x[1] + 3 * x[2]};
      },
      [](std::span<const double> x) { return std::vector<double>{x[1], x[0], 0, 0, 2 * x[1], 3}; });
}

std::vector<double> double_residuals(const Score& score) {
  std::vector<double> values = score.residuals;
  for (double& value : values) {
    value *= 2;
  }
  return values;
}

TEST(ExactDerivatives, AreTheChainRuleAndTheirEvaluationIsChargedFor) {
  const auto problem = make_products();
  MemoryEvaluator evaluator(*problem, {.budget = 100});
  DifferencedFunction function(evaluator, double_residuals, [](const Score& score) {
    return std::vector<double>(score.residuals.size(), 2.0);
  });
  const std::vector<double> at = {std::log(4), std::log(3), 0.25};
  EXPECT_THAT(function.evaluate_place(at, false).derivatives, IsEmpty());
  EXPECT_EQ(evaluator.charged(), 1);
  // By ln u, ln |v| and w; roundings of exp and log.
  const auto& place = function.evaluate_place(at, true);
  EXPECT_THAT(place.values, ElementsAre(DoubleNear(-24, 1e-13), DoubleNear(19.5, 1e-13)));
  EXPECT_THAT(place.derivatives,
              ElementsAre(ElementsAre(DoubleNear(-24, 1e-13), DoubleNear(0, 1e-13)),
                          ElementsAre(DoubleNear(-24, 1e-13), DoubleNear(36, 1e-13)),
                          ElementsAre(DoubleNear(0, 1e-13), DoubleNear(6, 1e-13))));
  EXPECT_EQ(evaluator.charged(), 1 + 2);  // 1 + 3/4, rounded up
  EXPECT_EQ(evaluator.trace().size(), 2U);
  function.evaluate_place(at, true);
  function.evaluate_place(at, false);
  EXPECT_EQ(evaluator.charged(), 3);
}

TEST(ExactDerivatives, AFailedPlaceHasNone) {
  const auto problem = make_products();
  MemoryEvaluator evaluator(*problem, {.budget = 100, .fail_every = 1});
  DifferencedFunction function(evaluator, double_residuals,
                               [](const Score& score) { return score.residuals; });
  const auto& place = function.evaluate_place({1, 1, 0}, true);
  EXPECT_THAT(place.values, IsEmpty());
  EXPECT_THAT(place.derivatives, IsEmpty());
}

TEST(ExactDerivatives, ChargesAreOneAndAQuarterAVariableRoundedUp) {
  for (const auto& [variables, charge] : {std::pair{1, 2}, {4, 2}, {5, 3}, {8, 3}, {20, 6}}) {
    EXPECT_EQ(calc_jacobian_charge(static_cast<std::size_t>(variables)), charge);
  }
}

}  // namespace
}  // namespace armwright
