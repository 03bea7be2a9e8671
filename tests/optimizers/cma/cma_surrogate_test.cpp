// The surrogate of CMA-ES: its model, its measure of agreement, and runs with it.
#include "optimizers/cma/cma_surrogate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <ranges>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;
using testing::Pointwise;

TEST(CmaSurrogate, TheRankCorrelationIsThatOfHandCounts) {
  const std::vector<double> a = {1, 2, 3, 4};
  EXPECT_EQ(calc_rank_agreement(a, std::vector<double>{10, 20, 30, 40}), 1);
  EXPECT_EQ(calc_rank_agreement(a, std::vector<double>{4, 3, 2, 1}), -1);
  // One of the six pairs is in another order: (5 - 1) / 6.
  EXPECT_DOUBLE_EQ(calc_rank_agreement(a, std::vector<double>{1, 3, 2, 4}), 4.0 / 6);
  // One pair is equal in the second list and counts as neither: 5 / 6.
  EXPECT_DOUBLE_EQ(calc_rank_agreement(a, std::vector<double>{1, 2, 2, 4}), 5.0 / 6);
  EXPECT_EQ(calc_rank_agreement(a, std::vector<double>{7, 7, 7, 7}), 0);
  EXPECT_EQ(calc_rank_agreement(std::vector<double>{1}, std::vector<double>{1}), 0);
}

// A quadratic with every product of two variables, and its minimum.
struct Quadratic {
  std::vector<double> minimum = {0.3, 0.6, 0.45, 0.7};

  double calc(std::span<const double> x) const {
    double value = -7;
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t k = 0; k < x.size(); ++k) {
        value += (i == k ? 5.0 + static_cast<double>(i) : 0.8) * (x[i] - minimum[i]) *
                 (x[k] - minimum[k]);
      }
    }
    return value;
  }
};

CmaDistribution make_distribution(std::size_t n, double sigma) {
  return {make_cma_parameters(n, {}), std::vector<double>(n, 0.5), sigma};
}

// Fills the surrogate with `count` points of the distribution's own kind.
void fill(CmaSurrogate& surrogate, std::size_t count,
          const std::function<double(std::span<const double>)>& calc) {
  RandomStream random("test/surrogate");
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> point(4);
    std::ranges::generate(point, [&] { return random.uniform(); });
    surrogate.add(point, calc(point));
  }
}

TEST(CmaSurrogate, TakesTheLargestModelThatThePointsAreEnoughFor) {
  // 3/4 of the points are to be 1.1 times the coefficients: 9 of a diagonal, 15 of a full model.
  for (const auto& [points, kind] : {std::pair{13, CmaModelKind::linear},
                                     {14, CmaModelKind::diagonal},
                                     {21, CmaModelKind::diagonal},
                                     {22, CmaModelKind::full}}) {
    CmaSurrogate surrogate(4, 8);
    fill(surrogate, static_cast<std::size_t>(points),
         [](std::span<const double> x) { return x[0]; });
    surrogate.fit(make_distribution(4, 0.2));
    EXPECT_EQ(surrogate.kind(), kind) << points;
  }
}

TEST(CmaSurrogate, IsExactOnAQuadraticOnceItIsFull) {
  const Quadratic quadratic;
  const auto calc = [&](std::span<const double> x) { return quadratic.calc(x); };
  CmaSurrogate surrogate(4, 8);
  fill(surrogate, 22, calc);
  surrogate.fit(make_distribution(4, 0.2));
  ASSERT_TRUE(surrogate.is_fitted());
  // A relative error of the coefficients of 1e-16 times the condition of the terms, some 1e3.
  for (const std::vector<double>& point :
       {std::vector<double>{0.1, 0.9, 0.2, 0.4}, std::vector<double>{2, -1, 0.5, 3}}) {
    EXPECT_NEAR(surrogate.calc_value(point), calc(point), 1e-9);
  }
  EXPECT_EQ(surrogate.calc_agreement(1), 1);
  EXPECT_THAT(surrogate.find_minimum(100), Pointwise(DoubleNear(1e-9), quadratic.minimum));
}

TEST(CmaSurrogate, TheMinimumStaysWithinItsRadius) {
  const Quadratic quadratic;
  CmaSurrogate surrogate(4, 8);
  fill(surrogate, 22, [&](std::span<const double> x) { return quadratic.calc(x); });
  surrogate.fit(make_distribution(4, 0.05));
  const std::vector<double> near = surrogate.find_minimum(1);
  double squares = 0;
  for (const double x : near) {
    squares += std::pow((x - 0.5) / 0.05, 2);
  }
  EXPECT_NEAR(std::sqrt(squares), 1, 1e-9);
  EXPECT_LT(quadratic.calc(near), quadratic.calc(std::vector<double>(4, 0.5)));
  // A saddle has no minimum: the best point of the ball is at its edge, along the falling direction.
  CmaSurrogate saddle(4, 8);
  fill(saddle, 22,
       [](std::span<const double> x) { return x[0] * x[0] - std::pow(x[1] - 0.4, 2) + x[2]; });
  saddle.fit(make_distribution(4, 0.05));
  EXPECT_GT(saddle.find_minimum(1)[1], 0.5);
}

TEST(CmaSurrogate, ForgetsTheOldestPoints) {
  CmaSurrogate surrogate(4, 8);
  fill(surrogate, 100, [](std::span<const double> x) { return x[0]; });
  EXPECT_EQ(surrogate.size(), 30);  // twice the 15 coefficients
  CmaSurrogate large(4, 80);
  fill(large, 100, [](std::span<const double> x) { return x[0]; });
  EXPECT_EQ(large.size(), 80);  // lambda
}

TEST(CmaSurrogate, EqualPointsLeaveAModelThatAgreesWithThem) {
  CmaSurrogate surrogate(4, 8);
  for (int i = 0; i < 30; ++i) {
    surrogate.add({0.1, 0.2, 0.3, i % 2 == 0 ? 0.4 : 0.5}, i % 2);
  }
  surrogate.fit(make_distribution(4, 0.2));
  ASSERT_TRUE(surrogate.is_fitted());
  EXPECT_NEAR(surrogate.calc_value(std::vector<double>{0.1, 0.2, 0.3, 0.5}), 1, 1e-9);
}

// --- runs

const std::vector<std::string> kWithSurrogate = {"surrogate=quadratic"};

std::int64_t count_to_target(const Problem& problem, double target,
                             std::vector<std::string> assignments = kWithSurrogate) {
  std::vector<std::int64_t> counts;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    MemoryEvaluator evaluator(problem, {.budget = 3500});
    minimize_with("cmaes", evaluator, seed, assignments);
    const auto hit = std::ranges::find_if(evaluator.trace(), [&](const MemoryEvaluator::Entry& e) {
      return e.score.objectives[0] < target;
    });
    counts.push_back(hit - evaluator.trace().begin() + 1);
  }
  std::ranges::sort(counts);
  return counts[1];
}

// docs/cmaes.md has more: factors of 38, 100 and 4. The limits are what the option promises.
TEST(CmaSurrogate, HalvesTheEvaluations) {
  for (const char* name : {"sphere", "ellipsoid", "rosenbrock"}) {
    const auto problem = make_analytic(name, 5);
    EXPECT_LT(2 * count_to_target(*problem, 1e-8), count_to_target(*problem, 1e-8, {})) << name;
  }
}

TEST(CmaSurrogate, EvaluatesAllPointsWhereTheModelOrdersThemWrongly) {
  // No polynomial agrees with numbers that have nothing to do with the variables.
  const auto problem = make_problem(5, 0.5, 0, 1, [](std::span<const double> x) {
    return std::fmod(1e7 * std::abs(x[0] + x[1] + x[2] + x[3] + x[4]), 1.0);
  });
  MemoryEvaluator evaluator(problem, {.budget = 400});
  minimize_with("cmaes", evaluator, 1, kWithSurrogate);
  std::map<std::int64_t, std::size_t> sizes;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    ++sizes[entry.generation];
  }
  // 8 points each; now and then 13 random pairs of 15 points agree by chance.
  EXPECT_GE(std::ranges::count(sizes | std::views::values, 8U),
            static_cast<std::ptrdiff_t>(sizes.size() - 5));
}

TEST(CmaSurrogate, EvaluatesInBatchesOfTheMultiple) {
  const auto problem = make_analytic("sphere", 6);
  for (const std::size_t multiple : {1, 4}) {
    MemoryEvaluator evaluator(*problem, {.budget = 60});
    minimize_with("cmaes", evaluator, 1,
                  {"surrogate=quadratic", "batch_multiple=" + std::to_string(multiple)});
    // The first batch is the start, and the budget cuts the last one.
    const auto sizes =
        std::span(evaluator.batch_sizes()).subspan(1, evaluator.batch_sizes().size() - 2);
    for (const std::size_t size : sizes) {
      EXPECT_EQ(size % multiple, 0);
    }
    EXPECT_EQ(std::ranges::min(sizes), multiple);
  }
}

TEST(CmaSurrogate, FailedPointsAreNoPointsOfTheModel) {
  // Every third evaluation fails, with a penalty that no quadratic could follow.
  const auto problem = make_analytic("sphere", 5);
  MemoryEvaluator evaluator(*problem, {.budget = 400, .fail_every = 3});
  minimize_with("cmaes", evaluator, 1, kWithSurrogate);
  double best = 1;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    best = std::min(best, entry.score.objectives[0]);
  }
  EXPECT_LT(best, 1e-8);
}

TEST(CmaSurrogate, WithoutItTheTraceIsThatOfNoOption) {
  const auto problem = make_analytic("rosenbrock", 4);
  MemoryEvaluator none(*problem, {.budget = 300});
  MemoryEvaluator unnamed(*problem, {.budget = 300});
  minimize_with("cmaes", none, 3, {"surrogate=none"});
  minimize_with("cmaes", unnamed, 3, {});
  EXPECT_EQ(none.trace(), unnamed.trace());
}

TEST(CmaSurrogate, ImpossibleCombinationsAreRefused) {
  const auto problem = make_analytic("sphere", 3);
  MemoryEvaluator evaluator(*problem, {.budget = 10});
  const auto message = [&](const std::string& other) {
    return usage_error_of([&] {
      minimize_with("cmaes", evaluator, 1, {"surrogate=quadratic", other});
    });
  };
  EXPECT_THAT(message("uncertainty_handling=true"), HasSubstr("leaves most of them without one"));
  EXPECT_THAT(message("feasibility_first=true"), HasSubstr("jumps where a constraint is met"));
  EXPECT_TRUE(evaluator.trace().empty());
}

class SurrogateContract : public testing::TestWithParam<const char*> {};

// The suite of every optimizer, with the option.
TEST_P(SurrogateContract, Holds) {
  const OptimizerRow& row = find_optimizer("cmaes");
  const auto check = std::ranges::find_if(contract_checks(), [](const ContractCheck& one) {
    return one.name == std::string(GetParam());
  });
  const ContractFinding finding =
      run_contract_check(*check, row, Options::parse(row.name, row.options, kWithSurrogate));
  EXPECT_NE(finding.outcome, ContractOutcome::broken) << finding.detail;
}

std::vector<const char*> list_checks() {
  std::vector<const char*> names;
  std::ranges::transform(contract_checks(), std::back_inserter(names), &ContractCheck::name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(CmaSurrogate, SurrogateContract, testing::ValuesIn(list_checks()),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace armwright
