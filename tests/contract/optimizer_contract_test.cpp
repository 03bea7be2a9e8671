// What every optimizer of the table must do, whatever it is: the same with the same seed, never
// more than the budget, stop when told to, survive failing evaluations and exceptions. New rows are
// covered by being in the table.
#include <gmock/gmock.h>

#include <cmath>

#include "optimizers/optimizer.hpp"
#include "problems/analytic.hpp"
#include "study/memory_evaluator.hpp"

namespace armwright {
namespace {

using Entry = MemoryEvaluator::Entry;

// Logarithmic variables of either sign, as robots have them: a bent bowl over three decades,
// minimum 0 at (900, -30, 2).
std::unique_ptr<Problem> make_log_bowl() {
  return std::make_unique<FunctionProblem>(
      std::vector<DecisionVariable>{{"p", "", 1, 10000, 100, Scale::logarithmic},
                                    {"tau_min", "", -10000, -1, -100, Scale::logarithmic},
                                    {"tau_max", "", 0.1, 1000, 10, Scale::logarithmic}},
      [](std::span<const double> x, std::uint64_t) {
        const double a = std::log(x[0] / 900);
        const double b = std::log(x[1] / -30);
        const double c = std::log(x[2] / 2);
        return a * a + b * b + c * c + 0.5 * std::pow(a + b * b, 2);
      });
}

std::unique_ptr<Problem> make_problem(const std::string& name) {
  return name == "log_bowl" ? make_log_bowl()
                            : make_analytic(name, find_analytic(name).default_dimension);
}

std::unique_ptr<Optimizer> make_optimizer(const std::string& name) {
  const OptimizerRow& row = find_optimizer(name);
  return row.make(Options::parse(name, row.options, {}));
}

double calc_start_value(const Problem& problem) {
  std::vector<double> start;
  for (const DecisionVariable& variable : problem.description().variables) {
    start.push_back(variable.start);
  }
  return problem.evaluate(start, {CaseRole::training, "train/test", {0}}).objectives.at(0);
}

std::string make_test_name(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return text;
}

std::vector<std::string> problem_names() {
  std::vector<std::string> names = analytic_names();
  names.push_back("log_bowl");
  return names;
}

class OptimizerContract : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  std::string optimizer_name() const { return std::get<0>(GetParam()); }
  const Capabilities& capabilities() const { return find_optimizer(optimizer_name()).capabilities; }
  const Problem& problem() const { return *problem_; }

  // One run of a new optimizer on a new evaluator.
  MemoryEvaluator run(const MemoryEvaluatorSettings& settings, std::uint64_t seed = 1) const {
    MemoryEvaluator evaluator(problem(), settings);
    make_optimizer(optimizer_name())->minimize(evaluator, seed);
    return evaluator;
  }

 private:
  std::unique_ptr<Problem> problem_ = make_problem(std::get<1>(GetParam()));
};

TEST_P(OptimizerContract, TheSameSeedGivesTheSameTrace) {
  EXPECT_EQ(run({.budget = 400}, 3).trace(), run({.budget = 400}, 3).trace());
}

TEST_P(OptimizerContract, TheSeedMattersWhereItSaysSo) {
  const bool is_same = run({.budget = 400}, 0).trace() == run({.budget = 400}, 1).trace();
  EXPECT_EQ(is_same, !capabilities().stochastic);
}

TEST_P(OptimizerContract, AnOptimizerKeepsNothingBetweenRuns) {
  const auto optimizer = make_optimizer(optimizer_name());
  MemoryEvaluator first(problem(), {.budget = 200});
  MemoryEvaluator second(problem(), {.budget = 200});
  optimizer->minimize(first, 3);
  optimizer->minimize(second, 3);
  EXPECT_EQ(first.trace(), second.trace());
}

TEST_P(OptimizerContract, ASmallerBudgetIsABeginningOfALargerOne) {
  // What resuming rests on. Optimizers that plan with remaining() do differ; they must say so here
  // when they come.
  const MemoryEvaluator small = run({.budget = 90});
  const MemoryEvaluator large = run({.budget = 300});
  ASSERT_LE(small.trace().size(), large.trace().size());
  for (std::size_t i = 0; i < small.trace().size(); ++i) {
    ASSERT_EQ(small.trace()[i].evaluated, large.trace()[i].evaluated) << "evaluation " << i;
  }
}

TEST_P(OptimizerContract, AsksForFinitePointsAndStaysInTheBoxWhereItSaysSo) {
  const MemoryEvaluator evaluator = run({.budget = 600});
  for (const Entry& entry : evaluator.trace()) {
    for (const double value : entry.asked) {
      ASSERT_TRUE(std::isfinite(value));
    }
    if (capabilities().bounds) {
      ASSERT_FALSE(entry.score.clipped);
    }
  }
}

TEST_P(OptimizerContract, TheBudgetIsNeverExceeded) {
  for (const std::int64_t budget : {1, 2, 36, 137}) {
    const MemoryEvaluator evaluator = run({.budget = budget});
    EXPECT_LE(evaluator.trace().size(), static_cast<std::size_t>(budget));
    EXPECT_GE(evaluator.trace().size(), 1u);
    EXPECT_LE(evaluator.calls_after_stop(), 1);
  }
}

TEST_P(OptimizerContract, AZeroBudgetIsARunWithoutEvaluations) {
  EXPECT_TRUE(run({.budget = 0}).trace().empty());
}

TEST_P(OptimizerContract, AStopIsHonoured) {
  for (const std::int64_t stop_after : {1, 35, 50}) {
    const MemoryEvaluator evaluator = run({.budget = INT64_MAX, .stop_after = stop_after});
    EXPECT_LE(evaluator.trace().size(), static_cast<std::size_t>(stop_after));
    EXPECT_LE(evaluator.calls_after_stop(), 1);
  }
}

TEST_P(OptimizerContract, FailingEvaluationsAreSurvived) {
  const MemoryEvaluator evaluator = run({.budget = 1000, .fail_every = 3});
  EXPECT_GE(evaluator.trace().size(), 100u);
  ASSERT_TRUE(evaluator.best().has_value());
  EXPECT_LT(*evaluator.best(), calc_start_value(problem()));
}

TEST_P(OptimizerContract, NothingButFailuresIsSurvived) {
  const MemoryEvaluator evaluator = run({.budget = 200, .fail_every = 1});
  EXPECT_GE(evaluator.trace().size(), 1u);
  EXPECT_FALSE(evaluator.best().has_value());
}

TEST_P(OptimizerContract, AnExceptionComesThroughAndLeavesNothingBehind) {
  const auto optimizer = make_optimizer(optimizer_name());
  for (const std::int64_t throw_at : {1, 2, 40}) {
    MemoryEvaluator broken(problem(), {.budget = 200, .throw_at = throw_at});
    try {
      optimizer->minimize(broken, 1);
      ADD_FAILURE() << "the exception at evaluation " << throw_at << " was swallowed";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "the evaluator is broken");
    }
    EXPECT_EQ(broken.trace().size(), static_cast<std::size_t>(throw_at - 1));
  }
  MemoryEvaluator sound(problem(), {.budget = 200});
  optimizer->minimize(sound, 1);
  EXPECT_EQ(sound.trace(), run({.budget = 200}).trace());
}

TEST_P(OptimizerContract, TheIncumbentBeatsTheStart) {
  const MemoryEvaluator evaluator = run({.budget = 2000});
  ASSERT_TRUE(evaluator.best().has_value());
  EXPECT_LT(*evaluator.best(), calc_start_value(problem()));
}

TEST_P(OptimizerContract, BatchesAndGenerationsAreAsDeclared) {
  const MemoryEvaluator evaluator = run({.budget = 200});
  const bool has_batches =
      std::ranges::any_of(evaluator.batch_sizes(), [](std::size_t size) { return size > 1; });
  EXPECT_EQ(has_batches, capabilities().batch);
  EXPECT_EQ(evaluator.generations() > 0, capabilities().generations);
  if (capabilities().generations) {
    EXPECT_EQ(evaluator.trace().front().generation, 1);  // the first is declared, too
  }
}

INSTANTIATE_TEST_SUITE_P(Table, OptimizerContract,
                         testing::Combine(testing::ValuesIn(optimizer_names()),
                                          testing::ValuesIn(problem_names())),
                         [](const auto& parameters) {
                           return make_test_name(std::get<0>(parameters.param) + "_on_" +
                                                 std::get<1>(parameters.param));
                         });

class OptimizerRowContract : public testing::TestWithParam<std::string> {};

TEST_P(OptimizerRowContract, DescribesItself) {
  const OptimizerRow& row = find_optimizer(GetParam());
  EXPECT_FALSE(row.summary.empty());
  EXPECT_FALSE(row.source.empty());
  EXPECT_EQ(std::ranges::count(optimizer_names(), row.name), 1);
}

TEST_P(OptimizerRowContract, EveryDefaultIsAllowedAndReadsBack) {
  const OptimizerRow& row = find_optimizer(GetParam());
  std::vector<std::string> assignments;
  for (const OptionSpec& spec : row.options) {
    EXPECT_FALSE(spec.description.empty()) << spec.name;
    assignments.push_back(spec.name + "=" + to_text(spec.fallback));
  }
  const Options given = Options::parse(row.name, row.options, assignments);
  EXPECT_EQ(given.values(), Options::parse(row.name, row.options, {}).values());
}

INSTANTIATE_TEST_SUITE_P(Table, OptimizerRowContract, testing::ValuesIn(optimizer_names()),
                         [](const auto& parameters) { return make_test_name(parameters.param); });

// Convergence: the median of five seeds, the same budget for both.
class GaBeatsRandomSearch : public testing::TestWithParam<std::string> {
 protected:
  double calc_median_best(const std::string& optimizer) const {
    const auto problem = make_analytic(GetParam(), 10);
    std::vector<double> best;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      MemoryEvaluator evaluator(*problem, {.budget = 5000});
      make_optimizer(optimizer)->minimize(evaluator, seed);
      best.push_back(evaluator.best().value());
    }
    std::ranges::sort(best);
    return best[2];
  }
};

TEST_P(GaBeatsRandomSearch, InTheMedian) {
  const double ga = calc_median_best("ga");
  const double random = calc_median_best("random");
  EXPECT_LT(ga, random / 10);  // no close call: measured 200, 25 and 370 times less
}

INSTANTIATE_TEST_SUITE_P(TenDimensions, GaBeatsRandomSearch,
                         testing::Values("sphere", "ellipsoid", "rosenbrock"),
                         [](const auto& parameters) { return parameters.param; });

}  // namespace
}  // namespace armwright
