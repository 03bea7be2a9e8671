#include "optimizers/builtin/latin_hypercube.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

const std::vector<DecisionVariable> kVariables = {
    {"linear", "", -3, 5, 1, Scale::linear},
    {"gain", "", 0.5, 5000, 1, Scale::logarithmic},
    {"negative", "", -2e6, -200, -2e4, Scale::logarithmic},
};

std::unique_ptr<Problem> make_mixed_problem() {
  return std::make_unique<FunctionProblem>(
      kVariables, [](std::span<const double> x, std::uint64_t) { return x[0] * x[0]; });
}

MemoryEvaluator run(const Problem& problem, std::int64_t budget,
                    const std::vector<std::string>& assignments, std::uint64_t seed = 1) {
  MemoryEvaluator evaluator(problem, {.budget = budget});
  const OptimizerRow& row = find_optimizer("lhs");
  row.make(Options::parse("lhs", row.options, assignments))->minimize(evaluator, seed);
  return evaluator;
}

// The interval, of `count`, in which a value lies on the variable's own scale.
int find_interval(const DecisionVariable& variable, double value, int count) {
  const double share =
      variable.scale == Scale::linear
          ? (value - variable.lower) / (variable.upper - variable.lower)
          : std::log(value / variable.lower) / std::log(variable.upper / variable.lower);
  return std::min(static_cast<int>(share * count), count - 1);
}

TEST(LatinHypercube, EveryIntervalOfEveryVariableHoldsOnePointOfADesign) {
  constexpr int kSamples = 37;
  const auto problem = make_mixed_problem();
  const MemoryEvaluator evaluator = run(*problem, 1 + 3 * kSamples, {"samples=37"});
  ASSERT_EQ(evaluator.trace().size(), 1u + 3 * kSamples);
  for (int design = 0; design < 3; ++design) {
    for (std::size_t i = 0; i < kVariables.size(); ++i) {
      std::vector<int> counts(kSamples, 0);
      for (int k = 0; k < kSamples; ++k) {
        const auto& entry = evaluator.trace()[static_cast<std::size_t>(1 + design * kSamples + k)];
        EXPECT_FALSE(entry.score.clipped);
        ++counts[static_cast<std::size_t>(find_interval(kVariables[i], entry.asked[i], kSamples))];
      }
      EXPECT_THAT(counts, testing::Each(1)) << "design " << design << ", variable " << i;
    }
  }
}

TEST(LatinHypercube, PairingsOfIntervalsAreDrawnAnew) {
  // 37! orders: the same one twice would be a fault.
  const auto problem = make_mixed_problem();
  const MemoryEvaluator evaluator = run(*problem, 75, {"samples=37"});
  std::vector<std::vector<int>> orders;
  for (std::size_t design = 0; design < 2; ++design) {
    for (std::size_t i = 0; i < kVariables.size(); ++i) {
      orders.emplace_back();
      for (std::size_t k = 0; k < 37; ++k) {
        const double value = evaluator.trace()[1 + design * 37 + k].asked[i];
        orders.back().push_back(find_interval(kVariables[i], value, 37));
      }
    }
  }
  std::ranges::sort(orders);
  EXPECT_EQ(std::ranges::adjacent_find(orders), orders.end());
}

TEST(LatinHypercube, BeginsAtTheStartAndAsksForADesignAtATime) {
  const auto problem = make_mixed_problem();
  const MemoryEvaluator evaluator = run(*problem, 250, {});
  EXPECT_THAT(evaluator.trace().front().asked, ElementsAre(1, 1, -2e4));
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(1, 100, 100, 100));
  EXPECT_EQ(evaluator.trace().size(), 250u);
}

TEST(LatinHypercube, TheBatchHasNoInfluenceOnThePoints) {
  const auto problem = make_analytic("sphere", 3);
  const MemoryEvaluator whole = run(*problem, 90, {"samples=40"}, 7);
  const MemoryEvaluator parts = run(*problem, 90, {"samples=40", "batch=16"}, 7);
  EXPECT_EQ(whole.trace(), parts.trace());
  EXPECT_THAT(parts.batch_sizes(), ElementsAre(1, 16, 16, 8, 16, 16, 8, 16));
}

// With 40 points per design, each of the 40 whole numbers of `teeth` gets one interval, and each of
// the 5 words gets eight.
TEST(LatinHypercube, ADesignHasEveryValueOfADiscreteVariableAsOften) {
  const OptimizerRow& row = find_optimizer("lhs");
  const auto problem = make_contract_problems(row).back();  // mixed_bowl
  MemoryEvaluator evaluator(*problem, {.budget = 41});
  row.make(Options::parse("lhs", row.options, std::vector<std::string>{"samples=40"}))
      ->minimize(evaluator, 1);
  std::map<double, int> teeth;
  std::map<double, int> oil;
  for (const MemoryEvaluator::Entry& entry : std::span(evaluator.trace()).subspan(1)) {
    ++oil[entry.asked[0]];
    ++teeth[entry.asked[2]];
  }
  EXPECT_EQ(teeth.size(), 40u);
  EXPECT_EQ(oil, (std::map<double, int>{{0, 8}, {1, 8}, {2, 8}, {3, 8}, {4, 8}}));
}

}  // namespace
}  // namespace armwright
