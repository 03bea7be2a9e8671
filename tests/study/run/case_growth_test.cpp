// Tests when growing training cases grow, and what runs make of it.
#include "study/run/case_growth.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <string>

#include "base/expect_error.hpp"
#include "study/run/run_folder.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kPlenty = 1'000'000;
constexpr int kWindow = 30;  // evaluations, of ten variables

// A growth on a problem of ten variables.
CaseGrowth make_growth(const char* schedule, bool generations = true) {
  static const LoadedProblem sphere = load_problem("sphere");
  RunPlan plan;
  plan.problem = sphere;
  plan.schedule = *read_schedule(schedule);
  plan.optimizer.capabilities = {.generations = generations, .growing = !generations};
  return CaseGrowth(plan);
}

// Adds evaluations whose best design has these errors; their mean is its objective.
void add(CaseGrowth& growth, int evaluations, const std::vector<double>& errors) {
  EvaluationRecord record;
  record.evaluation.case_errors = errors;
  double mean = 0;
  for (const double error : errors) {
    mean += error / static_cast<double>(errors.size());
  }
  for (int i = 0; i < evaluations; ++i) {
    growth.add(record, mean);
  }
}

TEST(CaseGrowth, CasesGrowWhenTheGainIsWithinTheNoiseBetweenThem) {
  // The standard error of two cases with errors m (1 +- 0.1) is 0.1 m.
  for (const auto& [gain, grows] : {std::pair{0.05, true}, {0.09, true}, {0.11, false}}) {
    CaseGrowth growth = make_growth("growing:2:3");
    EXPECT_FALSE(growth.grow(kPlenty));
    add(growth, 1, {(1 + gain) * 0.9, (1 + gain) * 1.1});
    EXPECT_FALSE(growth.grow(kPlenty)) << "too few evaluations";
    add(growth, kWindow, {0.9, 1.1});
    EXPECT_EQ(growth.grow(kPlenty), grows) << gain;
    EXPECT_EQ(growth.cases(), grows ? 6 : 2);
  }
}

TEST(CaseGrowth, AGenerationIsTheShortestTimeThatIsLookedAt) {
  CaseGrowth growth = make_growth("growing:2:2");
  growth.grow(kPlenty);
  add(growth, 50, {0.9, 1.1});  // one generation: no other to compare with
  EXPECT_FALSE(growth.grow(kPlenty));
  add(growth, 50, {0.9, 1.1});
  EXPECT_TRUE(growth.grow(kPlenty));
}

TEST(CaseGrowth, WithoutGenerationsTheTimeIsThatSinceTheOptimizerLastAsked) {
  CaseGrowth growth = make_growth("growing:2:2", false);
  add(growth, 10, {1.8, 2.2});
  EXPECT_FALSE(growth.grow(kPlenty)) << "nothing came before";
  add(growth, 3, {0.9, 1.1});
  EXPECT_FALSE(growth.grow(kPlenty)) << "a large gain";
  add(growth, 3, {0.89, 1.09});
  EXPECT_TRUE(growth.grow(kPlenty));
}

TEST(CaseGrowth, CasesWithoutANumberAreNoNoise) {
  CaseGrowth growth = make_growth("growing:3:2", false);
  const double none = std::numeric_limits<double>::quiet_NaN();
  EvaluationRecord record;
  record.evaluation.case_errors = {0.9, 1.1, none};
  for (int i = 0; i < 3; ++i) {
    growth.add(record, 1);
    EXPECT_EQ(growth.grow(kPlenty), i == 1);
  }
}

TEST(CaseGrowth, OneCaseAlwaysGrows) {
  CaseGrowth growth = make_growth("growing:1:1.5");
  add(growth, 1, {100});
  growth.grow(kPlenty);
  add(growth, kWindow, {1});
  EXPECT_TRUE(growth.grow(kPlenty));
  EXPECT_EQ(growth.cases(), 2);
}

TEST(CaseGrowth, TheRestOfTheBudgetMustPayForAModelOnMoreCases) {
  CaseGrowth growth = make_growth("growing:2:2");
  add(growth, 1, {0.9, 1.1});
  growth.grow(kPlenty);
  add(growth, kWindow, {0.9, 1.1});
  EXPECT_FALSE(growth.grow(43));
  add(growth, kWindow, {0.9, 1.1});
  EXPECT_TRUE(growth.grow(44));
}

TEST(CaseGrowth, FailuresAreNoProgress) {
  CaseGrowth growth = make_growth("growing:2:2");
  EvaluationRecord failed;
  for (int i = 0; i < 3 * kWindow; ++i) {
    growth.add(failed, std::numeric_limits<double>::infinity());
  }
  EXPECT_FALSE(growth.grow(kPlenty)) << "nothing is known of the noise";
}

TEST(GrowingSchedule, IsReadAndWritten) {
  EXPECT_EQ(to_text(*read_schedule("growing:3")), "growing:3:2");
  EXPECT_EQ(to_text(*read_schedule("growing:3:1.5")), "growing:3:1.5");
  for (const char* bad : {"growing", "growing:0:2", "growing:2:1", "growing:2:0.5", "growing:2:x",
                          "growing:2:2:2", "fixed:2:2"}) {
    EXPECT_FALSE(read_schedule(bad)) << bad;
  }
}

class GrowingRun : public RunTest, public testing::WithParamInterface<const char*> {};

TEST_P(GrowingRun, CasesAreTheFirstOnesAndNeverShrink) {
  RunPlan plan = make_small_plan(GetParam(), 400);
  plan.schedule = *read_schedule("growing:1:2");
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner);
  std::size_t cases = 1;
  std::uint64_t charged = 0;
  for (const EvaluationRecord& record : read("a").training) {
    const auto& numbers = record.cases.numbers;
    ASSERT_GE(numbers.size(), cases);
    cases = numbers.size();
    charged += cases;
    for (std::size_t i = 0; i < cases; ++i) {
      EXPECT_EQ(numbers[i], i);
    }
  }
  EXPECT_GT(cases, 1u) << "they never grew";
  EXPECT_EQ(result->counts.cases, charged);
  EXPECT_LE(charged, 400u);
}

TEST_P(GrowingRun, ThatIsStoppedEndsAsAnUninterruptedOne) {
  RunPlan plan = make_small_plan(GetParam(), 200);
  plan.schedule = *read_schedule("growing:1:2");
  run(plan, "whole");
  for (bool done = false; !done;) {
    StopSignal stop;
    StoppingObserver observer(stop, 30);
    done = execute_run({plan, temporary_ / "pieces", 2, {}}, stop, observer).has_value();
  }
  expect_same_evaluations(read("whole"), read("pieces"));
  EXPECT_EQ(read_result("whole"), read_result("pieces"));
}

INSTANTIATE_TEST_SUITE_P(, GrowingRun, testing::Values("ga", "dfls"),
                         [](const auto& one) { return std::string(one.param); });

TEST_F(RunTest, GrowingCasesNeedAnOptimizerThatTakesThem) {
  RunPlan plan = make_small_plan("random", 60);
  plan.schedule = *read_schedule("growing:1:2");
  EXPECT_THAT(error_of(ErrorKind::usage, [&] { check_plan(plan); }),
              HasSubstr("optimizer 'random' has no generations, so training cases that change "
                        "between them (schedule growing) are not possible"));
}

}  // namespace
}  // namespace armwright
