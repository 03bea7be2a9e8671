// The rows of pagmo: what they promise is what they do. That they do what pagmo alone would do
// stands in pagmo_exactness_test.cpp.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <typeinfo>

#include "base/expect_error.hpp"
#include "optimizers/pagmo/pagmo_backend.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

#ifndef ARMWRIGHT_WITH_PAGMO

TEST(Pagmo, SaysThatItIsMissing) {
  for (const OptimizerRow& row : make_pagmo_rows()) {
    EXPECT_THAT(row.unavailable, HasSubstr("ARMWRIGHT_WITH_PAGMO"));
  }
}

#else

// ZDT1 (Zitzler, Deb and Thiele 2000, Comparison of multiobjective evolutionary algorithms): the
// front is f2 = 1 - sqrt(f1), from (0, 1) to (1, 0). The start lies far above its middle.
class TwoObjectives : public Problem {
 public:
  TwoObjectives() {
    description_.name = "zdt1";
    description_.objectives = {{"f1", ""}, {"f2", ""}};
    description_.cost_unit = "function evaluation";
    for (int i = 0; i < 6; ++i) {
      description_.variables.push_back({"x", "", 0, 1, 0.5, Scale::linear});
    }
  }
  const ProblemDescription& description() const override { return description_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    return std::vector<CaseOutcome>(jobs.size());
  }
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> /*outcomes*/) const override {
    double g = 1;
    for (std::size_t i = 1; i < x.size(); ++i) {
      g += 9 * x[i] / static_cast<double>(x.size() - 1);
    }
    Evaluation evaluation;
    evaluation.objectives = {x[0], g * (1 - std::sqrt(x[0] / g))};
    return evaluation;
  }
  std::vector<double> penalty_objectives() const override { return {1e12, 1e12}; }

 private:
  ProblemDescription description_;
};

std::vector<std::string> select_names(bool multi_objective) {
  std::vector<std::string> names;
  for (const OptimizerRow& row : make_pagmo_rows()) {
    if (row.capabilities.multi_objective == multi_objective) {
      names.push_back(row.name);
    }
  }
  return names;
}

std::string make_test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::ranges::replace(name, ':', '_');
  return name;
}

bool begins_like(const MemoryEvaluator& small, const MemoryEvaluator& large) {
  return std::ranges::equal(small.trace(), large.trace() | std::views::take(small.trace().size()));
}

class PagmoRow : public testing::TestWithParam<std::string> {
 protected:
  const OptimizerRow& row() const { return find_optimizer(GetParam()); }
  const Problem& problem() const {
    return row().capabilities.multi_objective ? static_cast<const Problem&>(two_) : *sphere_;
  }
  MemoryEvaluator run(const MemoryEvaluatorSettings& settings, std::uint64_t seed = 1) const {
    return run_optimizer(GetParam(), problem(), settings, seed);
  }

 private:
  TwoObjectives two_;
  std::unique_ptr<Problem> sphere_ = make_analytic("sphere", 10);
};

TEST_P(PagmoRow, BeginsAtTheStartAndStaysInTheBox) {
  const MemoryEvaluator evaluator = run({.budget = 2000});
  const std::vector<DecisionVariable>& variables = problem().description().variables;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    EXPECT_EQ(evaluator.trace().front().asked[i], variables[i].start);
  }
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    ASSERT_FALSE(entry.score.clipped);
  }
}

TEST_P(PagmoRow, TheSeedAndNothingElseDecides) {
  const MemoryEvaluator evaluator = run({.budget = 300}, 5);
  EXPECT_EQ(evaluator.trace(), run({.budget = 300}, 5).trace());
  const bool is_stochastic = row().capabilities.stochastic;
  EXPECT_EQ(evaluator.trace() != run({.budget = 300}, 6).trace(), is_stochastic);
  // pagmo's seeds have 32 bits, ours 64
  EXPECT_EQ(evaluator.trace() != run({.budget = 300}, 5 + (1ULL << 32)).trace(), is_stochastic);
}

TEST_P(PagmoRow, ALargerBudgetChangesTheBeginningOnlyOfPacedOnes) {
  EXPECT_EQ(begins_like(run({.budget = 700}), run({.budget = 2000})), !row().capabilities.paced);
}

TEST_P(PagmoRow, AsksForBatchesWhereItSaysSo) {
  const MemoryEvaluator evaluator = run({.budget = 300});
  const auto batch_count =
      std::ranges::count_if(evaluator.batch_sizes(), [](std::size_t size) { return size > 1; });
  if (row().capabilities.batch) {
    EXPECT_GE(batch_count, 3);  // generations, not just the first population
  } else {
    EXPECT_EQ(batch_count, 0);
  }
}

TEST_P(PagmoRow, NoBudgetMeansNoEvaluation) {
  EXPECT_TRUE(run({.budget = 0}).trace().empty());
  EXPECT_EQ(run({.budget = 1}).trace().size(), 1u);
}

TEST_P(PagmoRow, UsesTheBudgetUpUnlessItEndsByItself) {
  if (row().capabilities.local) {
    EXPECT_LT(run({.budget = 5000}).trace().size(), 5000u);
  } else {
    EXPECT_EQ(run({.budget = 5000}).trace().size(), 5000u);
  }
}

TEST_P(PagmoRow, ExceptionsComeThrough) {
  for (const std::int64_t throw_at : {1, 2, 100}) {
    try {
      run({.budget = 200, .throw_at = throw_at});
      ADD_FAILURE() << "the exception at evaluation " << throw_at << " was swallowed";
    } catch (const std::exception& error) {
      EXPECT_EQ(typeid(error), typeid(BrokenEvaluator));
      EXPECT_STREQ(error.what(), "the evaluator is broken");
    }
  }
}

TEST_P(PagmoRow, FailingEvaluationsAreSurvived) {
  const MemoryEvaluator evaluator = run({.budget = 1000, .fail_every = 3});
  EXPECT_EQ(evaluator.trace().size(), 1000u);
  EXPECT_LT(evaluator.best().value(), evaluator.trace().front().score.objectives.front());
  EXPECT_EQ(run({.budget = 100, .fail_every = 1}).trace().size(), 100u);
}

INSTANTIATE_TEST_SUITE_P(SingleObjective, PagmoRow, testing::ValuesIn(select_names(false)),
                         make_test_name);
INSTANTIATE_TEST_SUITE_P(MultiObjective, PagmoRow, testing::ValuesIn(select_names(true)),
                         make_test_name);

class PagmoSingleObjective : public testing::TestWithParam<std::string> {};

// A tenth of the start's value is no close call: measured, the worst keeps 0.017 of it.
TEST_P(PagmoSingleObjective, FindsItsWayOnEitherScale) {
  const auto sphere = make_analytic("sphere", 10);
  const auto log_bowl = make_log_bowl();
  for (const Problem* problem : {sphere.get(), log_bowl.get()}) {
    const MemoryEvaluator evaluator = run_optimizer(GetParam(), *problem, {.budget = 2000});
    EXPECT_LT(evaluator.best().value(), evaluator.trace().front().score.objectives.front() / 10)
        << problem->description().name;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, PagmoSingleObjective, testing::ValuesIn(select_names(false)),
                         make_test_name);

// How near the evaluated points come to one end of the front.
double calc_distance(const MemoryEvaluator& evaluator, double f1, double f2) {
  double nearest = INFINITY;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    nearest = std::min(nearest,
                       std::hypot(entry.score.objectives[0] - f1, entry.score.objectives[1] - f2));
  }
  return nearest;
}

class PagmoMultiObjective : public testing::TestWithParam<std::string> {};

TEST_P(PagmoMultiObjective, FindsBothEndsOfTheFront) {
  const TwoObjectives problem;
  const MemoryEvaluator random = run_optimizer("random", problem, {.budget = 4000});
  const MemoryEvaluator evaluator = run_optimizer(GetParam(), problem, {.budget = 4000});
  RecordProperty("left", std::to_string(calc_distance(evaluator, 0, 1)));
  RecordProperty("right", std::to_string(calc_distance(evaluator, 1, 0)));
  EXPECT_LT(calc_distance(evaluator, 0, 1), calc_distance(random, 0, 1) / 2);
  EXPECT_LT(calc_distance(evaluator, 1, 0), calc_distance(random, 1, 0) / 2);
}

INSTANTIATE_TEST_SUITE_P(Table, PagmoMultiObjective, testing::ValuesIn(select_names(true)),
                         make_test_name);

TEST(Pagmo, ConstraintsAreRespected) {
  const auto problem = make_analytic("constrained");  // the minimum is -44
  for (const std::string name : {"pagmo:gaco", "pagmo:ihs", "pagmo:mbh"}) {
    EXPECT_TRUE(find_optimizer(name).capabilities.constraints);
    EXPECT_LT(run_optimizer(name, *problem, {.budget = 4000}).best().value(), -43) << name;
  }
  for (const std::string name : {"pagmo:de", "pagmo:cmaes", "pagmo:pso"}) {  // by a penalty
    EXPECT_FALSE(find_optimizer(name).capabilities.constraints);
    EXPECT_LT(run_optimizer(name, *problem, {.budget = 4000}).best().value(), -43) << name;
  }
}

TEST(Pagmo, ThePenaltyForConstraintsIsAnOption) {
  const auto problem = make_analytic("constrained");
  const MemoryEvaluator blind =
      run_optimizer("pagmo:cmaes", *problem, {.budget = 4000}, 1, {"constraint_weight=0"});
  const std::vector<double>& last = blind.trace().back().score.constraint_values;
  EXPECT_GT(*std::ranges::max_element(last), 0.1);
}

TEST(Pagmo, SpreadIsTheWidthOfTheFirstPopulation) {
  const auto problem = make_analytic("sphere", 10);
  const DecisionVariable& variable = problem->description().variables.front();
  for (const double spread : {0.0, 0.2}) {
    const MemoryEvaluator evaluator = run_optimizer("pagmo:de", *problem, {.budget = 24}, 1,
                                                    {"spread=" + std::to_string(spread)});
    double farthest = 0;
    for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
      for (const double value : entry.asked) {
        farthest = std::max(farthest, std::abs(value - variable.start));
      }
    }
    const double reach = spread / 2 * (variable.upper - variable.lower);
    EXPECT_LE(farthest, reach);
    EXPECT_GE(farthest, 0.9 * reach);  // of 230 draws; chance of a miss: 0.9^230 = 3e-11
  }
}

void expect_refused(const std::string& name, const std::vector<std::string>& options,
                    const std::string& what) {
  const OptimizerRow& row = find_optimizer(name);
  EXPECT_THAT(usage_error_of([&] { row.make(Options::parse(name, row.options, options)); }),
              AllOf(HasSubstr("'" + name + "'"), HasSubstr(what)));
}

TEST(Pagmo, OptionsThatDoNotFitAreRefusedBeforeTheRun) {
  expect_refused("pagmo:gaco", {"population=20"}, "'ker' is 31");
  expect_refused("pagmo:maco", {"ker=33"}, "'population', which is 32");
  expect_refused("pagmo:nsga2", {"population=66"}, "multiple of 4");
  expect_refused("pagmo:moead", {"population=20"}, "'neighbours' is 20");
  // what pagmo itself refuses
  expect_refused("pagmo:nsga2", {"cr=1"}, "crossover");
  expect_refused("pagmo:ihs", {"ppar_min=0.9", "ppar_max=0.5"}, "pitch");
  expect_refused("pagmo:simulated_annealing", {"Ts=0.1", "Tf=0.2"}, "temperature");
  expect_refused("de", {"population=3"}, "'population'");
}

TEST(Pagmo, DeIsPagmosDe) {
  const auto problem = make_analytic("rosenbrock", 10);
  EXPECT_EQ(run_optimizer("de", *problem, {.budget = 500}).trace(),
            run_optimizer("pagmo:de", *problem, {.budget = 500}).trace());
}

#endif

}  // namespace
}  // namespace armwright
