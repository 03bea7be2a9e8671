#include "optimizers/builtin/random_search.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <span>
#include <tuple>

#include "optimizers/kolmogorov_smirnov.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

std::vector<double> draw(const DecisionVariable& variable, int count) {
  RandomStream random("test/random_search");
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(draw_coordinate(variable, random));
  }
  return values;
}

TEST(RandomSearch, LinearCoordinatesAreUniform) {
  std::vector<double> shares;
  for (const double value : draw({"v", "", -3, 5, 0, Scale::linear}, 200000)) {
    shares.push_back((value + 3) / 8);
  }
  EXPECT_LT(calc_kolmogorov_smirnov(shares), kKolmogorovSmirnovBound);
}

TEST(RandomSearch, LogarithmicCoordinatesAreUniformInTheLogarithm) {
  std::vector<double> shares;
  for (const double value : draw({"v", "", 0.5, 5000, 1, Scale::logarithmic}, 200000)) {
    shares.push_back(std::log(value / 0.5) / std::log(1e4));
  }
  EXPECT_LT(calc_kolmogorov_smirnov(shares), kKolmogorovSmirnovBound);
}

TEST(RandomSearch, NegativeLogarithmicCoordinatesKeepTheirSign) {
  std::vector<double> shares;
  for (const double value : draw({"v", "", -2e6, -200, -2e4, Scale::logarithmic}, 200000)) {
    ASSERT_GE(value, -2e6);
    ASSERT_LE(value, -200);
    shares.push_back(std::log(value / -200) / std::log(1e4));
  }
  EXPECT_LT(calc_kolmogorov_smirnov(shares), kKolmogorovSmirnovBound);
}

TEST(RandomSearch, BeginsAtTheStartAndAsksInBatches) {
  const auto problem = make_analytic("sphere", 2);
  MemoryEvaluator evaluator(*problem, {.budget = 70});
  const OptimizerRow& row = find_optimizer("random");
  row.make(Options::parse("random", row.options, {}))->minimize(evaluator, 1);
  EXPECT_THAT(evaluator.trace().front().asked, ElementsAre(-2.5, -2.5));
  EXPECT_NE(evaluator.trace()[1].asked, evaluator.trace()[0].asked);
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(32, 32, 32));
  EXPECT_EQ(evaluator.trace().size(), 70u);
}

TEST(RandomSearch, TheBatchHasNoInfluenceOnThePoints) {
  const auto problem = make_analytic("sphere", 3);
  const OptimizerRow& row = find_optimizer("random");
  MemoryEvaluator small(*problem, {.budget = 50});
  MemoryEvaluator large(*problem, {.budget = 50});
  row.make(Options::parse("random", row.options, std::vector<std::string>{"batch=1"}))
      ->minimize(small, 7);
  row.make(Options::parse("random", row.options, std::vector<std::string>{"batch=64"}))
      ->minimize(large, 7);
  EXPECT_EQ(small.trace(), large.trace());
}

// Chi-square with 39 degrees of freedom (40 whole numbers) exceeds 72.1 once in a thousand seeds,
// with 4 (5 words) 18.5.
TEST(RandomSearch, EveryValueOfADiscreteVariableIsAsLikely) {
  const OptimizerRow& row = find_optimizer("random");
  const auto problem = make_contract_problems(row).back();  // mixed_bowl
  constexpr int kDraws = 20000;
  MemoryEvaluator evaluator(*problem, {.budget = kDraws + 1});
  row.make(Options::parse("random", row.options, {}))->minimize(evaluator, 1);
  for (const auto& [variable, values, bound] :
       std::vector<std::tuple<std::size_t, int, double>>{{0, 5, 18.5}, {2, 40, 72.1}}) {
    std::map<double, int> counts;
    for (const MemoryEvaluator::Entry& entry : std::span(evaluator.trace()).subspan(1)) {
      ++counts[entry.asked[variable]];
    }
    EXPECT_EQ(std::ssize(counts), values);
    const double expected = double{kDraws} / values;
    double chi_square = 0;
    for (const auto& [value, count] : counts) {
      chi_square += (count - expected) * (count - expected) / expected;
    }
    EXPECT_LT(chi_square, bound) << variable;
  }
}

}  // namespace
}  // namespace armwright
