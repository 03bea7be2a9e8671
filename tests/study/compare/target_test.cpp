// Fixed targets and failing test cases, with cells whose numbers allow computation by hand.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/expect_error.hpp"
#include "study/analysis/study_result.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/choices.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr const char* kFunctions = R"(problems = ["sphere", "rosenbrock"]
optimizers = ["ga", "cmaes"]
set = ["function.dimension=3"]
replicates = 6
budget = 120
)";

constexpr const char* kArm = R"(problems = ["q1-complex"]
optimizers = ["ga", "cmaes"]
replicates = 4
budget = 100
checkpoints = 3
baselines = false
set = ["physics.engine=articulated", "sets.test_cases=10", "sets.validation_cases=3"]
)";

CellOutcome make_cell(const std::string& optimizer, int replicate,
                      std::vector<CurvePoint> choices) {
  CellOutcome cell;
  cell.problem = "q1-complex";
  cell.optimizer = optimizer;
  cell.replicate = replicate;
  cell.cases = 100;
  cell.value = cell.validation_value = 1;
  cell.start_value = 2;
  cell.errors.cases = 10;
  cell.choices = std::move(choices);
  return cell;
}

TEST(TargetTrial, IsReachedWhereAChosenDesignMeetsIt) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string(kArm) + R"(
[[target]]
label = "good"
value = 1.0
failures = 1
)");
  const auto find = [&](std::vector<CurvePoint> choices) {
    const CellOutcome cell = make_cell("ga", 1, std::move(choices));
    return make_target_trial(plan, plan.targets[0], cell, cell.choices);
  };
  const auto expect = [](const Trial& trial, double cost, bool reached) {
    EXPECT_EQ(trial.cost, cost);
    EXPECT_EQ(trial.reached, reached);
  };
  expect(find({{10, 1.0, 1}, {20, 0.5, 0}, {30, 0.4, 0}}), 10, true);
  // Later choices do not count; otherwise a longer run would need longer to reach the target.
  expect(find({{10, 1.1, 0}, {20, 0.9, 0}, {30, 1.1, 0}}), 20, true);
  // The target asks for few failures; the objective does not matter.
  expect(find({{10, 0.9, 2}, {20, 0.9, 3}, {30, 0.9, 1}}), 30, true);
  expect(find({{10, 0.9, 2}, {20, 0.9, 3}, {30, 0.9, 2}}), 100, false);
  expect(find({{10, kInf, 10}, {20, kInf, 10}, {30, 0.9, std::nullopt}}), 100, false);
  expect(find({}), 100, false);
  // A run that ended after 25 cases has spent only these, even if the last checkpoint is later.
  const auto find_ended = [&](std::vector<CurvePoint> choices) {
    CellOutcome cell = make_cell("ga", 1, std::move(choices));
    cell.cases = 25;
    return make_target_trial(plan, plan.targets[0], cell, cell.choices);
  };
  expect(find_ended({{10, 1.1, 0}, {20, 1.1, 0}, {30, 0.4, 0}}), 25, true);
  expect(find_ended({{10, 1.1, 0}, {20, 0.4, 0}, {30, 0.4, 0}}), 20, true);
  expect(find_ended({{10, 1.1, 0}, {20, 1.1, 0}, {30, 1.1, 0}}), 25, false);
}

TEST(TargetTimes, AreChargedWithTheFailures) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string("reference = \"ga\"\n") + kArm + R"(
[[target]]
label = "good"
value = 1.0
)");
  std::vector<CellOutcome> cells;
  const std::vector<CurvePoint> never = {{10, 3, 0}, {30, 2, 0}};
  // ga: two of four, at 10 and 30, the others spend 100 each: (10 + 30 + 200) / 2 = 120.
  cells.push_back(make_cell("ga", 1, {{10, 0.9, 0}, {30, 1.1, 0}}));  // misses it at 30
  cells.push_back(make_cell("ga", 2, {{10, 2, 0}, {30, 0.8, 0}}));
  cells.push_back(make_cell("ga", 3, never));
  cells.push_back(make_cell("ga", 4, never));
  for (int r = 1; r <= 4; ++r) {  // cmaes: always at 10
    cells.push_back(make_cell("cmaes", r, {{10, 0.9, 0}, {30, 0.8, 0}}));
  }
  const ProblemResult result = analyze_problem(plan, 0, cells);
  ASSERT_THAT(result.fixed_targets, ElementsAre(0u));
  const TargetTime& ga = result.optimizers[0].target_times[0];
  EXPECT_EQ(ga.reached, 2);
  EXPECT_EQ(ga.kept, 1);
  EXPECT_EQ(ga.expected, 120);
  // All four resampled runs fail with probability 1/16, which is more than the 2.5 % left out.
  EXPECT_EQ(ga.interval.upper, kInf);
  EXPECT_EQ(*ga.ratio->ratio, 1);
  const TargetTime& cmaes = result.optimizers[1].target_times[0];
  EXPECT_EQ(cmaes.reached, 4);
  EXPECT_EQ(cmaes.kept, 4);
  EXPECT_EQ(cmaes.expected, 10);
  EXPECT_EQ(cmaes.interval.lower, 10);
  EXPECT_EQ(cmaes.interval.upper, 10);
  EXPECT_DOUBLE_EQ(*cmaes.ratio->ratio, 10.0 / 120);
  EXPECT_EQ(cmaes.ratio->interval.lower, 0);  // from resamples in which ga fails four times
}

TEST(FailureShares, AreComparedAsValuesAre) {
  const TemporaryFolder folder;
  std::string toml = kArm;
  toml.replace(toml.find("replicates = 4"), 14, "replicates = 7");
  const StudyPlan plan = load_plan(folder, toml);
  std::vector<CellOutcome> cells;
  for (const std::string optimizer : {"ga", "cmaes"}) {
    for (int r = 1; r <= 7; ++r) {
      cells.push_back(make_cell(optimizer, r, {}));
      cells.back().errors.failures = optimizer == "ga" ? static_cast<std::uint64_t>(r) : 0;
    }
  }
  const ProblemResult result = analyze_problem(plan, 0, cells);
  EXPECT_THAT(result.optimizers[0].failure_shares, ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7));
  EXPECT_DOUBLE_EQ(result.optimizers[0].mean_failure_share, 0.4);
  ASSERT_EQ(result.failure_pairs.size(), 1u);
  EXPECT_EQ(result.failure_pairs[0].test.p_value, 2.0 / 128);  // all seven in one direction
  EXPECT_TRUE(result.failure_pairs[0].is_won_by(1));
  EXPECT_FALSE(result.pairs[0].is_significant());  // their values are equal
}

TEST(FailureShares, TakeThePlaceOfValuesWhereThePlanSaysSo) {
  CellOutcome cell = make_cell("ga", 1, {});
  cell.errors.failures = 2;
  cell.start_failures = 10;
  cell.curve = {{5, 0.001, 4}, {10, 0.002, std::nullopt}};
  CaseSets sets;
  sets.test_cases = 10;
  const CellOutcome counted = count_failures_only(cell, sets);
  EXPECT_EQ(counted.value, 0.2);
  EXPECT_EQ(counted.start_value, 1);
  EXPECT_EQ(counted.curve[0].value, 0.4);
  EXPECT_EQ(counted.curve[1].value, kInf);
  cell.errors.cases = 0;  // no winner
  EXPECT_EQ(count_failures_only(cell, sets).value, kInf);
}

TEST(Cells, OfBeforeFailuresWereRecordedAreStillRead) {
  CellOutcome cell = make_cell("ga", 1, {{10, 0.5, 3}});
  cell.curve = {{10, 0.25, 7}};
  cell.start_failures = 9;
  const CellOutcome same = parse_cell(to_json(cell), "cell.json");
  EXPECT_EQ(same.choices[0].failures, 3u);
  EXPECT_EQ(same.curve[0].failures, 7u);
  EXPECT_EQ(same.start_failures, 9u);
  auto j = nlohmann::json::parse(to_json(cell));
  j.erase("choices");
  j.erase("start_failures");
  j["curve"] = {{10, 0.25}};
  const CellOutcome old = parse_cell(j.dump(), "cell.json");
  EXPECT_EQ(old.curve[0].value, 0.25);
  EXPECT_FALSE(old.curve[0].failures);
  EXPECT_FALSE(old.start_failures);
  EXPECT_TRUE(old.choices.empty());
}

TEST(StudyTargets, MistakesAreNamed) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& top, const std::string& end,
                          const std::string& message) {
    EXPECT_THAT(usage_error_of([&] { load_plan(folder, top + kFunctions + end); }),
                HasSubstr(message));
  };
  expect("", "[[target]]\nlabel = 'a'\n", "it must have a value (the objective on the test set");
  expect("", "[[target]]\nlabel = 'a'\nvalue = 1\n[[target]]\nlabel = 'a'\nvalue = 2\n",
         "two targets of the study are called 'a'");
  expect("", "[[target]]\nlabel = 'a'\nvalue = 1\nproblems = ['spere']\n",
         "target 'a': unknown problem 'spere'");
  expect("", "[[target]]\nlabel = 'a'\nfailures = 0\n",
         "target 'a' counts failing test cases, and sphere is a function");
  expect("", "[[target]]\nlabel = 'a'\nfailures = -1\n", "target[0].failures is -1");
  expect("reference = 'gaa'\n", "[[target]]\nlabel = 'a'\nvalue = 1\n",
         "reference: unknown optimizer 'gaa'");
  expect("reference = 'ga'\n", "", "but the study has no [[target]]");
  expect("value = 'failures'\n", "", "but sphere is a function");
  expect("value = 'failure'\n", "",
         "mine.toml:1: unknown value 'failure'; did you mean 'failures'?");
}

TEST_F(StudyTest, TargetsComeToTablesAndVerdictAndCanBeAddedLater) {
  const TemporaryFolder folder;
  const StudyPlan without = load_plan(folder, kFunctions);
  study(without, "study");
  const StudyPlan plan =
      load_plan(folder, std::string("reference = \"random\"\n") + kFunctions + R"(
[[target]]
label = "near"
problems = ["sphere"]
value = 1.0
[[target]]
label = "nowhere"
value = -1.0
)");
  EXPECT_EQ(analyze_study(plan, temporary_ / "study").missing.size(), 60u);  // they lack choices
  const StudyResult result = study(plan, "study");
  study(plan, "at-once");
  EXPECT_EQ(read_tree(temporary_ / "study" / "tables"),
            read_tree(temporary_ / "at-once" / "tables"));
  EXPECT_THAT(read_tree(temporary_ / "study" / "tables").at("targets.csv"),
              HasSubstr("sphere,near,1,,ga,"));
  for (const CellOutcome& cell : result.cells) {
    EXPECT_EQ(cell.choices.size(), cell.curve.size());
    // A function has the same value on every set. So the choices never get worse, and the last one
    // has the value of the winner.
    for (std::size_t i = 1; i < cell.choices.size(); ++i) {
      EXPECT_LE(cell.choices[i].value, cell.choices[i - 1].value);
    }
    EXPECT_EQ(cell.choices.back().value, cell.value);
  }
  const auto verdict = describe_verdict(plan, result);
  EXPECT_THAT(verdict, Contains(HasSubstr("To the target 'near' (")));
  EXPECT_THAT(verdict, Contains(HasSubstr("To the target 'nowhere' (f at most -1) on rosenbrock "
                                          "no run of any optimizer came.")));
}

TEST_F(StudyTest, AResolvedPlanWithTargetsAndMethodsReadsBackAsItself) {
  const TemporaryFolder folder;
  const StudyPlan plan =
      load_plan(folder, std::string("value = \"failures\"\nreference = \"one\"\n") + kArm + R"(
[[optimizer]]
name = "ga"
label = "one"
schedule = "fresh:1"
[[target]]
label = "holds, \"really\""
failures = 0
)");
  std::ofstream(folder / "resolved.toml") << to_toml(plan);
  StudyRequest request;
  request.file = (folder / "resolved.toml").string();
  EXPECT_EQ(to_toml(make_study_plan(request)), to_toml(plan));
}

}  // namespace
}  // namespace armwright
