#include "optimizers/table/multistart.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/expect_error.hpp"
#include "optimizers/interface/search_space.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Compass search: one variable at a time, half the step when nothing helps. Ends by itself.
class CompassSearch : public Optimizer {
 public:
  CompassSearch(double step, std::vector<std::uint64_t>* seeds) : step_(step), seeds_(seeds) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    seeds_->push_back(seed);
    std::vector<double> x;
    for (const DecisionVariable& variable : evaluator.problem().variables) {
      x.push_back(variable.start);
    }
    double best = 0;
    if (!try_point(evaluator, x, best)) {
      return;
    }
    for (double step = step_; step > 1e-3;) {
      bool has_moved = false;
      for (std::size_t i = 0; i < x.size(); ++i) {
        for (const double side : {step, -step}) {
          std::vector<double> moved = x;
          moved[i] += side;
          double value = 0;
          if (!try_point(evaluator, moved, value)) {
            return;
          }
          if (value < best) {
            best = value;
            x = moved;
            has_moved = true;
          }
        }
      }
      step = has_moved ? step : step / 2;
    }
  }

 private:
  static bool try_point(Evaluator& evaluator, const std::vector<double>& x, double& value) {
    const std::vector<Score> scores = evaluator.evaluate({&x, 1});
    if (scores.empty()) {
      EXPECT_TRUE(evaluator.stopped());
      EXPECT_EQ(evaluator.remaining(), 0);
      return false;
    }
    value = scores[0].objectives[0];
    return true;
  }

  double step_;
  std::vector<std::uint64_t>* seeds_;
};

class MultistartTest : public testing::Test {
 protected:
  OptimizerRow make_inner() {
    return {.name = "compass",
            .summary = "Compass search",
            .source = "Hooke and Jeeves 1961",
            .capabilities = {.local = true},
            .options = {{.name = "step",
                         .description = "first step",
                         .fallback = 0.5,
                         .lower = 0,
                         .upper = 10}},
            .make = [this](const Options& options) -> std::unique_ptr<Optimizer> {
              return std::make_unique<CompassSearch>(options.get_number("step"), &seeds_);
            },
            .requirements = {.variables = 2}};
  }

  MemoryEvaluator run(const Problem& problem, const MemoryEvaluatorSettings& settings,
                      const std::vector<std::string>& assignments, std::uint64_t seed = 1) {
    const OptimizerRow row = make_multistart_row(make_inner());
    MemoryEvaluator evaluator(problem, settings);
    row.make(Options::parse(row.name, row.options, assignments))->minimize(evaluator, seed);
    return evaluator;
  }

  const std::vector<std::uint64_t>& seeds() const { return seeds_; }  // of the inner starts

 private:
  std::vector<std::uint64_t> seeds_;
};

TEST_F(MultistartTest, TheRowIsTheInnerOnesButForWhatItAdds) {
  const OptimizerRow row = make_multistart_row(make_inner());
  EXPECT_EQ(row.name, "multistart:compass");
  EXPECT_THAT(row.source, HasSubstr("Hooke"));
  EXPECT_EQ(row.requirements.variables, 2);
  EXPECT_TRUE(row.capabilities.stochastic);
  EXPECT_FALSE(row.capabilities.local);
  std::vector<std::string> names;
  std::ranges::transform(row.options, std::back_inserter(names), &OptionSpec::name);
  EXPECT_THAT(names, ElementsAre("step", "spread", "evaluations_per_start"));
}

TEST_F(MultistartTest, FindsTheDeepValleyWhereOneStartDoesNot) {
  const auto problem = make_analytic("rastrigin", 2);
  MemoryEvaluator once(*problem, {.budget = 4000});
  make_inner().make(Options::parse("compass", make_inner().options, {}))->minimize(once, 1);
  EXPECT_GT(once.best().value(), 0.9);  // another valley: the nearest is 1 deep
  EXPECT_LT(once.trace().size(), 200u);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const MemoryEvaluator many = run(*problem, {.budget = 4000}, {}, seed);
    EXPECT_EQ(many.trace().size(), 4000u);
    found += many.best().value() < 0.1 ? 1 : 0;
  }
  EXPECT_GE(found, 5);
}

TEST_F(MultistartTest, TheFirstStartIsTheProblemsAndEveryOneHasItsOwnSeed) {
  const auto problem = make_analytic("sphere", 2);
  const MemoryEvaluator evaluator = run(*problem, {.budget = 300}, {});
  EXPECT_THAT(evaluator.trace().front().asked, ElementsAre(-2.5, -2.5));
  EXPECT_GT(seeds().size(), 3u);
  std::vector<std::uint64_t> sorted = seeds();
  std::ranges::sort(sorted);
  EXPECT_EQ(std::ranges::adjacent_find(sorted), sorted.end());
}

TEST_F(MultistartTest, AStartIsGivenUpWhenItsAllowanceIsSpent) {
  const auto problem = make_analytic("sphere", 2);
  const MemoryEvaluator evaluator =
      run(*problem, {.budget = 95}, {"evaluations_per_start=10", "spread=0.5"});
  EXPECT_EQ(evaluator.trace().size(), 95u);
  EXPECT_EQ(seeds().size(), 10u);
  EXPECT_EQ(evaluator.calls_after_stop(), 0);
  // The box is -5 to 5 and the start -2.5: half of the way to either side.
  for (std::size_t first = 0; first < evaluator.trace().size(); first += 10) {
    EXPECT_THAT(evaluator.trace()[first].asked,
                testing::Each(AllOf(testing::Ge(-3.75), testing::Le(1.25))));
  }
  EXPECT_NE(evaluator.trace()[10].asked, evaluator.trace()[20].asked);
}

TEST_F(MultistartTest, LogarithmicStartsKeepTheirSign) {
  const FunctionProblem problem(
      {{"p", "", 1, 10000, 100, Scale::logarithmic},
       {"limit", "", -10000, -1, -100, Scale::logarithmic}},
      [](std::span<const double> x, std::uint64_t) { return x[0] - x[1]; });
  const MemoryEvaluator evaluator =
      run(problem, {.budget = 2000}, {"evaluations_per_start=1", "step=1"});
  int large = 0;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    EXPECT_FALSE(entry.score.clipped);
    large += entry.asked[0] > 100 ? 1 : 0;
  }
  EXPECT_NEAR(large, 1000, 150);  // half of the logarithm's range; six standard deviations
}

TEST_F(MultistartTest, OptionsReachTheInnerOptimizer) {
  const auto problem = make_analytic("sphere", 2);
  const MemoryEvaluator evaluator = run(*problem, {.budget = 2}, {"step=0.25"});
  EXPECT_THAT(evaluator.trace()[1].asked, ElementsAre(-2.25, -2.5));
}

TEST_F(MultistartTest, EndsWhereTheInnerOptimizerAsksForNothing) {
  class Idle : public Optimizer {
   public:
    explicit Idle(int* count) : count_(count) {}
    void minimize(Evaluator& /*evaluator*/, std::uint64_t /*seed*/) override { ++*count_; }

   private:
    int* count_;
  };
  int count = 0;
  OptimizerRow idle = make_inner();
  idle.options.clear();
  idle.make = [&](const Options& /*options*/) { return std::make_unique<Idle>(&count); };
  const OptimizerRow row = make_multistart_row(idle);
  const auto problem = make_analytic("sphere", 2);
  MemoryEvaluator evaluator(*problem, {.budget = 100});
  row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator, 1);
  EXPECT_EQ(count, 2);
}

TEST_F(MultistartTest, AnExceptionComesThrough) {
  const auto problem = make_analytic("sphere", 2);
  EXPECT_THROW(run(*problem, {.budget = 1000, .throw_at = 400}, {}), std::runtime_error);
}

TEST_F(MultistartTest, ASmallerBudgetIsABeginningOfALargerOne) {
  const auto problem = make_analytic("rastrigin", 2);
  const auto small = run(*problem, {.budget = 400}, {}).trace();
  const auto large = run(*problem, {.budget = 900}, {}).trace();
  ASSERT_EQ(small.size(), 400u);
  EXPECT_TRUE(std::equal(small.begin(), small.end(), large.begin()));
}

TEST_F(MultistartTest, WhatCannotBeRestartedIsRefused) {
  EXPECT_THAT(usage_error_of([] { load_optimizer("multistart:random"); }),
              HasSubstr("optimizer 'multistart:random': 'random' is no local optimizer"));
  EXPECT_THAT(usage_error_of([&] { make_multistart_row(make_multistart_row(make_inner())); }),
              HasSubstr("'multistart:compass' is no local optimizer"));
  EXPECT_THAT(usage_error_of([] { load_optimizer("multistart:randon"); }),
              HasSubstr("unknown optimizer 'randon'; did you mean 'random'?"));
  OptimizerRow spread = make_inner();
  spread.options[0].name = "spread";
  EXPECT_THAT(usage_error_of([&] { make_multistart_row(spread); }),
              HasSubstr("'compass' has an option 'spread' itself"));
}

TEST(Multistart, DrawsWholeStartsForAnOptimizerOfIntegers) {
  OptimizerRow inner;
  inner.name = "inner";
  inner.capabilities = {.local = true, .integer = true, .categorical = true};
  inner.make = [](const Options&) -> std::unique_ptr<Optimizer> {
    class Start : public Optimizer {
      void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
        std::vector<double> x;
        for (const DecisionVariable& variable : evaluator.problem().variables) {
          x.push_back(variable.start);
        }
        evaluator.evaluate({&x, 1});
      }
    };
    return std::make_unique<Start>();
  };
  const OptimizerRow row = make_multistart_row(inner);
  const auto problem = make_contract_problems(row).back();  // mixed_bowl
  MemoryEvaluator evaluator(*problem, {.budget = 50, .capabilities = row.capabilities});
  row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator, 1);
  ASSERT_EQ(evaluator.trace().size(), 50u);
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    EXPECT_EQ(entry.asked, entry.evaluated);
  }
  EXPECT_NE(evaluator.trace()[1].asked, evaluator.trace()[2].asked);
}

}  // namespace
}  // namespace armwright
