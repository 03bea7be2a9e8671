#include "optimizers/differences.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "optimizers/test_problems.hpp"
#include "problems/analytic.hpp"
#include "study/memory_evaluator.hpp"

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
  const DifferencedFunction::Place place = function.look_at(at, true);
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
    function.look_at({1, 5}, with_derivatives);
    function.look_at({1, 6}, false);
  }
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(1, 1, 2));
}

TEST(Differences, TheEndOfTheBudgetComesOut) {
  const auto problem = make_cubic();
  MemoryEvaluator evaluator(*problem, {.budget = 2});
  DifferencedFunction function(evaluator, take_value, {.central = false, .step = 0.05});
  EXPECT_THROW(function.look_at({1, 5}, true), EvaluatorStopped);
  EXPECT_EQ(evaluator.trace().size(), 2u);
}

}  // namespace
}  // namespace armwright
