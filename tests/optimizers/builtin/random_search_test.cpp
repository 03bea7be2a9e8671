#include "optimizers/builtin/random_search.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "optimizers/kolmogorov_smirnov.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

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

}  // namespace
}  // namespace armwright
