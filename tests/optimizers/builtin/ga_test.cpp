// The structure of a run of the genetic algorithm: what it asks the evaluator for, and when.
#include "optimizers/builtin/ga.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/expect_error.hpp"
#include "optimizers/kolmogorov_smirnov.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using Entry = MemoryEvaluator::Entry;

void run(MemoryEvaluator& evaluator, const std::vector<std::string>& assignments = {},
         std::uint64_t seed = 1) {
  const OptimizerRow& row = find_optimizer("ga");
  row.make(Options::parse("ga", row.options, assignments))->minimize(evaluator, seed);
}

std::span<const Entry> generation_of(const MemoryEvaluator& evaluator, std::size_t generation,
                                     std::size_t size) {
  return std::span(evaluator.trace()).subspan((generation - 1) * size, size);
}

std::vector<std::size_t> rank_entries(std::span<const Entry> entries) {
  std::vector<Fitness> fitness;
  for (const Entry& entry : entries) {
    ProblemDescription problem;
    problem.constraints.resize(entry.score.constraint_values.size());
    fitness.push_back(calc_fitness(problem, entry.score));
  }
  return rank(fitness);
}

// Gains in the thesis's manner: start/100 ... start*100 with either sign.
std::vector<DecisionVariable> make_gains() {
  return {{"p", "", 450, 4.5e6, 45000, Scale::logarithmic},
          {"tau_min", "", -2e6, -200, -20000, Scale::logarithmic},
          {"tau_max", "", 200, 2e6, 20000, Scale::logarithmic}};
}

TEST(Ga, DefaultsAreThePublishedParameters) {
  const OptimizerRow& row = find_optimizer("ga");
  const Options options = Options::parse("ga", row.options, {});
  EXPECT_EQ(options.get_integer("population"), 35);
  EXPECT_EQ(options.get_integer("elite"), 2);
  EXPECT_EQ(options.get_number("tournament_probability"), 0.7);
  EXPECT_EQ(options.get_number("crossover_probability"), 0.75);
  EXPECT_EQ(options.get_number("crossover_extent"), 0.25);
  EXPECT_EQ(options.get_number("mutation_probability"), 0.05);
  EXPECT_EQ(options.get_number("mutation_factor"), 2);
  EXPECT_EQ(options.get_number("initial_mutation_probability"), 0.8);
  EXPECT_EQ(options.get_number("initial_mutation_factor"), 10);
  EXPECT_FALSE(options.get_bool("include_prototype"));
  EXPECT_EQ(options.get_integer("generations"), 0);
}

TEST(Ga, TheEliteMustBeSmallerThanThePopulation) {
  const auto problem = make_analytic("sphere", 2);
  MemoryEvaluator evaluator(*problem, {.budget = 10});
  EXPECT_EQ(usage_error_of([&] {
              run(evaluator, {"population=5", "elite=5"});
            }),
            "optimizer 'ga': option 'elite' is 5; it must be smaller than option 'population', "
            "which is 5");
  EXPECT_TRUE(evaluator.trace().empty());
}

TEST(Ga, OneBatchAGenerationUntilTheBudgetEnds) {
  const auto problem = make_analytic("sphere", 4);
  MemoryEvaluator evaluator(*problem, {.budget = 4 * 35 + 10});
  run(evaluator);
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(35, 35, 35, 35, 35));
  EXPECT_EQ(evaluator.trace().size(), 150u);
  EXPECT_EQ(evaluator.generations(), 5);
  for (std::size_t i = 0; i < 150; ++i) {
    EXPECT_EQ(evaluator.trace()[i].generation, static_cast<std::int64_t>(i / 35 + 1));
  }
  EXPECT_EQ(evaluator.calls_after_stop(), 0);
}

TEST(Ga, ABudgetOfWholeGenerationsEndsWithoutAnotherOne) {
  const auto problem = make_analytic("sphere", 4);
  MemoryEvaluator evaluator(*problem, {.budget = 70});
  run(evaluator);
  EXPECT_EQ(evaluator.generations(), 2);
}

TEST(Ga, GenerationsEndTheRun) {
  const auto problem = make_analytic("sphere", 4);
  MemoryEvaluator evaluator(*problem, {.budget = 10000});
  run(evaluator, {"generations=3", "population=10"});
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(10, 10, 10));
  EXPECT_EQ(evaluator.generations(), 3);
}

TEST(Ga, TheEliteIsCopiedBitForBitAndEvaluatedAgain) {
  // Every generation measures the distance to another target, so that yesterday's scores are worth
  // nothing.
  const FunctionProblem problem(make_gains(), [](std::span<const double> x, std::uint64_t number) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += std::pow(std::log(std::abs(x[i])) - static_cast<double>((number * 7 + i) % 11), 2);
    }
    return sum;
  });
  MemoryEvaluator evaluator(problem, {.budget = 20 * 35, .fresh = true});
  run(evaluator);
  int changes = 0;
  for (std::size_t generation = 1; generation < 20; ++generation) {
    const auto before = generation_of(evaluator, generation, 35);
    const auto after = generation_of(evaluator, generation + 1, 35);
    const std::vector<std::size_t> ranking = rank_entries(before);
    EXPECT_EQ(after[0].asked, before[ranking[0]].evaluated);
    EXPECT_EQ(after[1].asked, before[ranking[1]].evaluated);
    EXPECT_NE(after[0].score.objectives, before[ranking[0]].score.objectives);
    changes += rank_entries(after)[0] != 0 ? 1 : 0;
  }
  EXPECT_GT(changes, 0);  // the test would see an elite kept for its old scores
}

TEST(Ga, WithoutAnEliteEveryoneIsAChild) {
  const auto problem = make_analytic("sphere", 8);
  MemoryEvaluator evaluator(*problem, {.budget = 70});
  run(evaluator, {"elite=0", "crossover_extent=0.2", "crossover_probability=1"});
  const auto before = generation_of(evaluator, 1, 35);
  const auto after = generation_of(evaluator, 2, 35);
  EXPECT_NE(after[0].asked, before[rank_entries(before)[0]].evaluated);
}

TEST(Ga, ThePopulationCarriesWhatWasEvaluated) {
  // The objective drives every gene to its upper bound, where mutation asks for more than there is.
  const FunctionProblem problem(make_gains(), [](std::span<const double> x, std::uint64_t) {
    return -std::log(x[0]) - std::log(-x[1]) - std::log(x[2]);
  });
  MemoryEvaluator evaluator(problem, {.budget = 60 * 35});
  run(evaluator, {"mutation_probability=0.5"});
  const auto clipped = std::ranges::count_if(
      evaluator.trace(), [](const Entry& entry) { return entry.score.clipped; });
  EXPECT_GT(clipped, 0);
  for (std::size_t generation = 1; generation < 60; ++generation) {
    const auto before = generation_of(evaluator, generation, 35);
    const auto after = generation_of(evaluator, generation + 1, 35);
    EXPECT_EQ(after[0].asked, before[rank_entries(before)[0]].evaluated);
    EXPECT_FALSE(after[0].score.clipped);
  }
}

TEST(Ga, TheFirstGenerationIsMutatedFromTheStart) {
  const FunctionProblem problem(make_gains(),
                                [](std::span<const double> x, std::uint64_t) { return x[0]; });
  MemoryEvaluator evaluator(problem, {.budget = 20000});
  run(evaluator, {"population=20000"});
  std::vector<double> positions;
  for (const Entry& entry : evaluator.trace()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double ratio = entry.asked[i] / problem.description().variables[i].start;
      ASSERT_GT(ratio, 0.1 - 1e-15);
      ASSERT_LT(ratio, 10);
      if (ratio != 1) {
        positions.push_back(0.5 + 0.5 * std::log10(ratio));
      }
    }
  }
  // 0.8 within four standard deviations
  EXPECT_NEAR(static_cast<double>(positions.size()) / 60000, 0.8, 4 * std::sqrt(0.16 / 60000));
  EXPECT_LT(calc_kolmogorov_smirnov(positions), kKolmogorovSmirnovBound);
}

TEST(Ga, ThePrototypeComesFirstWhereItIsIncluded) {
  const auto problem = make_analytic("sphere", 6);
  const std::vector<double> start(6, -2.5);
  MemoryEvaluator without(*problem, {.budget = 35});
  run(without);
  for (const Entry& entry : without.trace()) {
    EXPECT_NE(entry.asked, start);
  }
  MemoryEvaluator with(*problem, {.budget = 35});
  run(with, {"include_prototype=true"});
  EXPECT_EQ(with.trace()[0].asked, start);
  EXPECT_NE(with.trace()[1].asked, start);
}

TEST(Ga, WithoutOperatorsOnlyTheFittestSurvive) {
  // No crossover, no mutation and a sure tournament: the children are copies of the first
  // generation, never of its worst.
  const auto problem = make_analytic("sphere", 3);
  MemoryEvaluator evaluator(*problem, {.budget = 20});
  run(evaluator, {"population=10", "crossover_probability=0", "mutation_probability=0",
                  "tournament_probability=1"});
  const auto first = generation_of(evaluator, 1, 10);
  const auto second = generation_of(evaluator, 2, 10);
  const std::size_t worst = rank_entries(first).back();
  for (const Entry& child : second) {
    const auto parent = std::ranges::find(first, child.asked, &Entry::evaluated);
    ASSERT_NE(parent, first.end());
    EXPECT_NE(parent - first.begin(), static_cast<std::ptrdiff_t>(worst));
  }
}

TEST(Ga, BothParentsMayBeTheSameIndividual) {
  // Two individuals with equal chances, and a child is the mean of its parents: each parent is
  // drawn from both of them, so the child is the mean of the two in half of the cases and a copy of
  // one in the others.
  const auto problem = make_analytic("sphere", 5);
  constexpr int kRuns = 2000;
  int means = 0;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    MemoryEvaluator evaluator(*problem, {.budget = 3});
    run(evaluator,
        {"population=2", "elite=0", "tournament_probability=0.5", "crossover_probability=1",
         "crossover_extent=0", "mutation_probability=0"},
        seed);
    const Entry& child = evaluator.trace()[2];
    const bool is_copy = child.asked == evaluator.trace()[0].evaluated ||
                         child.asked == evaluator.trace()[1].evaluated;
    means += is_copy ? 0 : 1;
  }
  EXPECT_NEAR(means / double{kRuns}, 0.5, 4 * std::sqrt(0.25 / kRuns));  // four standard deviations
}

TEST(Ga, LinearVariablesCanChangeTheirSign) {
  const FunctionProblem problem({{"v", "", -5, 5, 0, Scale::linear}},
                                [](std::span<const double> x, std::uint64_t) { return x[0]; });
  MemoryEvaluator evaluator(problem, {.budget = 2000});
  run(evaluator);
  EXPECT_LT(evaluator.best().value(), -4.9);
}

TEST(Ga, FindsTheFeasibleOptimum) {
  // 0.5 of 44 is two orders below what a random feasible point misses; the median run comes within
  // 0.2.
  const auto problem = make_analytic("constrained");
  std::vector<double> best;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    MemoryEvaluator evaluator(*problem, {.budget = 5000});
    run(evaluator, {}, seed);
    best.push_back(evaluator.best().value());
  }
  std::ranges::sort(best);
  EXPECT_LT(best[2], -43.5);
}

// Random search meets (medium, 7, 90) with probability 1/5 * 1/40 * 0.0013 per evaluation, so not
// once in a hundred runs of 3500.
TEST(Ga, FindsTheWordAndTheWholeNumbersOfAMixedProblem) {
  const auto problem = make_contract_problems(find_optimizer("ga")).back();  // mixed_bowl
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    MemoryEvaluator evaluator(*problem, {.budget = 3500});
    run(evaluator, {}, seed);
    const auto value = [](const Entry& entry) {
      return entry.score.objectives[0] + entry.score.objectives[1];
    };
    const Entry& best = *std::ranges::min_element(evaluator.trace(), {}, value);
    EXPECT_EQ((std::vector{best.evaluated[0], best.evaluated[2], best.evaluated[3]}),
              (std::vector<double>{2, 7, 90}))
        << "seed " << seed << ": " << value(best);
  }
}

}  // namespace
}  // namespace armwright
