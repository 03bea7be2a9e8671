// Tests the breeding of test cases on examples computed by hand, and that cases become harder.
#include "study/run/case_breeder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/expect_error.hpp"
#include "problems/config/problem_loader.hpp"
#include "sim/tracking/test_case.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

void show(CaseBreeder& breeder, double objective, std::vector<double> errors) {
  EvaluationRecord record;
  record.cases.numbers = breeder.genomes();
  record.evaluation.objectives = {objective};
  record.evaluation.case_errors = std::move(errors);
  breeder.add(record, objective);
}

std::vector<std::uint64_t> pick(const std::vector<std::uint64_t>& genomes,
                                std::initializer_list<std::size_t> places) {
  std::vector<std::uint64_t> some;
  for (const std::size_t place : places) {
    some.push_back(genomes[place]);
  }
  return some;
}

std::vector<std::uint64_t> take_first(const CaseBreeder& breeder, std::ptrdiff_t count) {
  return {breeder.genomes().begin(), breeder.genomes().begin() + count};
}

TEST(CaseBreeder, BeginsWithDifferentCasesOfTheSet) {
  const CaseBreeder breeder("coevolved/1", 50);
  const std::set<std::uint64_t> all(breeder.genomes().begin(), breeder.genomes().end());
  EXPECT_EQ(all.size(), 50u);
  EXPECT_LT(*all.rbegin(), std::uint64_t{1} << 60);
  EXPECT_EQ(breeder.genomes(), CaseBreeder("coevolved/1", 50).genomes());
  EXPECT_NE(breeder.genomes(), CaseBreeder("coevolved/2", 50).genomes());
}

TEST(CaseBreeder, TheHarderHalfStaysHardestFirst) {
  CaseBreeder breeder("coevolved/1", 8);
  const auto before = breeder.genomes();
  show(breeder, 1, {1, 5, 2, 8, 3, 7, 4, 6});
  breeder.breed();
  ASSERT_EQ(breeder.genomes().size(), 8u);
  EXPECT_EQ(take_first(breeder, 4), pick(before, {3, 5, 7, 1}));
  const std::set<std::uint64_t> all(breeder.genomes().begin(), breeder.genomes().end());
  EXPECT_EQ(all.size(), 8u) << "no case is there twice";
}

TEST(CaseBreeder, WithoutEvaluationsNothingChanges) {
  CaseBreeder breeder("coevolved/1", 8);
  const auto before = breeder.genomes();
  breeder.breed();
  EXPECT_EQ(breeder.genomes(), before);
}

TEST(CaseBreeder, HopelessDesignsDoNotDecide) {
  CaseBreeder breeder("coevolved/1", 4);
  const auto before = breeder.genomes();
  show(breeder, 9, {9, 9, 1, 1});  // the worse half
  show(breeder, 8, {9, 9, 1, 1});
  show(breeder, 1, {1, 1, 2, 3});
  show(breeder, 2, {1, 1, 2, 3});
  breeder.breed();
  EXPECT_EQ(take_first(breeder, 2), pick(before, {3, 2}));
}

// One design loses the target on case 0; case 1 is hard for two designs. Without the cap, log 1e6
// would decide.
TEST(CaseBreeder, OneLostTargetDoesNotOutweighAllElse) {
  CaseBreeder breeder("coevolved/1", 4);
  const auto before = breeder.genomes();
  show(breeder, 1, {1e6, 1, 1, 1});
  for (const double objective : {2.0, 3.0}) {
    show(breeder, objective, {1, 20, 1, 1});
  }
  for (const double objective : {7.0, 8.0, 9.0}) {
    show(breeder, objective, {1, 1, 1, 1});
  }
  breeder.breed();
  EXPECT_EQ(breeder.genomes().front(), before[1]);
}

TEST(CaseBreeder, ACaseWithoutANumberIsAsHardAsCanBe) {
  CaseBreeder breeder("coevolved/1", 4);
  const auto before = breeder.genomes();
  show(breeder, 1, {1, 1.5, std::nan(""), 1});
  breeder.breed();
  EXPECT_EQ(take_first(breeder, 2), pick(before, {2, 1}));
}

TEST(CaseBreeder, DesignsThatDidNotHaveAllCasesDoNotCount) {
  CaseBreeder breeder("coevolved/1", 4);
  const auto before = breeder.genomes();
  show(breeder, 1, {1, 2});
  breeder.breed();
  EXPECT_EQ(breeder.genomes(), before);
}

TEST(CaseBreeder, ChildrenHaveTheirParentsKeys) {
  CaseBreeder breeder("coevolved/1", 80);
  std::vector<double> errors(80);
  std::iota(errors.rbegin(), errors.rend(), 1.0);
  show(breeder, 1, errors);
  breeder.breed();
  // 40 cases stay, 30 are children, 10 are new. The 30 children have 120 keys, of which an eighth
  // is new: 105 are expected from parents, standard deviation 3.6. New cases share keys by chance
  // only: 40 keys in 2^15 values against 40 parents.
  const auto& genomes = breeder.genomes();
  const auto count_inherited = [&](std::size_t first, std::size_t end) {
    int inherited = 0;
    for (std::size_t i = first; i < end; ++i) {
      for (int place = 0; place < kGenomeKeys; ++place) {
        inherited += std::any_of(genomes.begin(), genomes.begin() + 40, [&](std::uint64_t parent) {
          return get_key(parent, place) == get_key(genomes[i], place);
        });
      }
    }
    return inherited;
  };
  EXPECT_NEAR(count_inherited(40, 70), 105, 4 * 3.6);
  EXPECT_LE(count_inherited(70, 80), 2);
}

double calc_mean_log(std::span<const double> errors) {
  double sum = 0;
  for (const double error : errors) {
    sum += std::log(error);
  }
  return sum / static_cast<double>(errors.size());
}

// Breeds cases against the start design of the thesis's second problem for 25 generations. Compares
// the mean log error of the 20 bred cases with that of 400 random ones.
TEST(CaseBreeder, CasesBecomeHarderForTheRobot) {
  const LoadedProblem loaded =
      load_problem("q2-e6", std::vector<std::string>{"physics.engine=articulated"});
  const std::vector<double> x = loaded.tracking()->make_vector(loaded.tracking()->config().start);
  const auto evaluate = [&](const std::string& set, std::vector<std::uint64_t> numbers) {
    return loaded.problem->evaluate(x, {CaseRole::training, set, std::move(numbers)}).case_errors;
  };
  CaseBreeder breeder("coevolved/1", 20);
  for (int generation = 0; generation < 25; ++generation) {
    show(breeder, 1, evaluate("coevolved/1", breeder.genomes()));
    breeder.breed();
  }
  std::vector<std::uint64_t> numbers(400);
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
  const std::vector<double> random = evaluate("train/1", numbers);
  const double mean = calc_mean_log(random);
  double square = 0;
  for (const double error : random) {
    square += std::pow(std::log(error) - mean, 2) / 400;
  }
  const double bred = calc_mean_log(evaluate("coevolved/1", breeder.genomes()));
  // The standard deviation of the mean of 20 random cases is sqrt(square / 20).
  EXPECT_GT(bred, mean + 4 * std::sqrt(square / 20));
}

// The generations of a run train on bred cases, under another set name. Validation and test sets
// are the usual ones.
TEST_F(RunTest, CoevolvedGenerationsTrainOnWhatWasBred) {
  RunPlan plan = make_small_plan("ga", 8 * 6 * 4);
  plan.schedule = {.kind = Schedule::Kind::coevolution, .cases = 6};
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner);
  EXPECT_EQ(result->counts.generations, 4u);
  CaseBreeder breeder("coevolved/1", 6);
  std::uint64_t generation = 1;
  for (const EvaluationRecord& record : read("a").training) {
    if (record.generation != generation) {
      breeder.breed();
      ++generation;
    }
    EXPECT_EQ(record.cases.set, "coevolved/1");
    EXPECT_EQ(record.cases.numbers, breeder.genomes());
    breeder.add(record, record.evaluation.objectives.front());
  }
  for (const EvaluationRecord& record : read("a").judgements) {
    EXPECT_THAT(record.cases.set, testing::AnyOf("validation/1", "test/2"));
  }
}

TEST_F(RunTest, CoevolutionNeedsGenerationsAndRoomForChildren) {
  RunPlan plan = make_small_plan("random");
  plan.schedule = {.kind = Schedule::Kind::coevolution, .cases = 6};
  EXPECT_THAT(usage_error_of([&] { run(plan, "a"); }),
              HasSubstr("between them (schedule coevolution) are not possible"));
  plan = make_small_plan("ga");
  plan.schedule = {.kind = Schedule::Kind::coevolution, .cases = 3};
  EXPECT_THAT(usage_error_of([&] { run(plan, "a"); }),
              HasSubstr("breeds 3 training cases; there must be at least 4"));
}

}  // namespace
}  // namespace armwright
