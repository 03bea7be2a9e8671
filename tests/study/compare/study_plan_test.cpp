#include "study/compare/study_plan.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "base/expect_error.hpp"
#include "study/compare/case_sets.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> get_labels(const StudyPlan& plan) {
  std::vector<std::string> labels;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    labels.push_back(optimizer.label);
  }
  return labels;
}

constexpr const char* kStudyHead = "problems = ['sphere']\nbudget = 100\nreplicates = 3\n";

// The user sees which entry of the file is wrong.
TEST(StudyFile, AnErrorOfAProblemOrOptimizerNamesItsPlace) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& toml) {
    return usage_error_of([&] { load_plan(folder, toml); });
  };
  const std::string lists = "budget = 60\nproblems = ['sphere',\n  'spere']\n";
  EXPECT_THAT(refuse(lists + "optimizers = ['ga']\n"),
              HasSubstr("mine.toml:3: problems[1]: unknown problem 'spere'; did you mean"));
  const std::string sphere = "budget = 60\n[[problem]]\nname = 'sphere'\n";
  EXPECT_THAT(refuse(sphere + "set = ['function.dimension=0']\n[[optimizer]]\nname = 'ga'\n"),
              HasSubstr("mine.toml:3: problem[0].name: problem sphere: --set "
                        "function.dimension=0: function.dimension is 0; it must be"));
  EXPECT_THAT(refuse(sphere + "[[optimizer]]\nname = 'ga'\n[[optimizer]]\nname = 'gaa'\n"),
              HasSubstr("mine.toml:7: optimizer[1].name: unknown optimizer 'gaa'"));
  EXPECT_THAT(refuse("budget = 60\nproblems = ['sphere']\noptimizers = ['ga', 'gaa']\n"),
              HasSubstr("mine.toml:3: optimizers[1]: unknown optimizer 'gaa'"));
}

TEST(StudyPlan, BaselinesTakePartUnlessAskedNotTo) {
  StudyRequest request = make_small_request();
  EXPECT_THAT(get_labels(make_study_plan(request)),
              ElementsAre("ga", "cmaes", "start", "random", "nlopt:neldermead"));
  request.optimizers = {"random", "nlopt:cobyla"};  // one baseline itself, and another local search
  EXPECT_THAT(get_labels(make_study_plan(request)), ElementsAre("random", "nlopt:cobyla", "start"));
  request.baselines = false;
  request.optimizers = {"ga"};
  EXPECT_THAT(get_labels(make_study_plan(request)), ElementsAre("ga"));
}

TEST(StudyPlan, NoOptimizerCanBeGivenMoreThanOthers) {
  const TemporaryFolder folder;
  for (const std::string privilege :
       {"budget = 200", "replicates = 9", "seed = 4", "start_spread = 0.5"}) {
    const std::string toml = std::string(kStudyHead) +
                             "optimizers = ['ga']\n[[optimizer]]\nname = 'cmaes'\n" + privilege +
                             "\n";
    EXPECT_THAT(usage_error_of([&] { load_plan(folder, toml); }),
                HasSubstr("it is the same for every optimizer of a comparison"));
  }
  const std::string unknown =
      std::string(kStudyHead) +
      "optimizers = ['ga']\n[[optimizer]]\nname = 'cmaes'\nevaluations = 5\n";
  EXPECT_THAT(usage_error_of([&] { load_plan(folder, unknown); }),
              HasSubstr("unknown key optimizer[0].evaluations"));
}

TEST(StudyPlan, MistakesAreNamed) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& toml, const std::string& message) {
    EXPECT_THAT(usage_error_of([&] { load_plan(folder, toml); }), HasSubstr(message));
  };
  expect("optimizers = ['ga']\nbudget = 10\n", "the study names no problem");
  expect("problems = ['sphere']\nbudget = 10\n", "the study names no optimizer");
  expect("problems = ['sphere']\noptimizers = ['ga']\n", "the study names no budget");
  expect(std::string(kStudyHead) + "optimizers = ['gaa']\n", "did you mean 'ga'?");
  expect(std::string(kStudyHead) + "optimizers = ['ga', 'ga']\n",
         "two optimizers of the study are called 'ga'");
  expect("problems = ['sphere', 'sphere']\nbudget = 100\noptimizers = ['ga']\n",
         "two problems of the study are called 'sphere'");
  expect(std::string(kStudyHead) + "optimizers = ['ga']\nschedule = 'sometimes'\n",
         "schedule is 'sometimes'; it must be fresh:K");
  expect(std::string(kStudyHead) + "optimizers = ['ga']\nschedule = 'fixed:101'\n",
         "a budget of 100 cases does not pay for one evaluation");
}

TEST(StudyPlan, ASettingThatOneProblemDoesNotKnowIsRefusedWithTheProblem) {
  StudyRequest request = make_small_request();
  request.problems = {"sphere", "q1-complex"};
  EXPECT_THAT(usage_error_of([&] { make_study_plan(request); }),
              HasSubstr("problem q1-complex: --set function.dimension=3: unknown key function"));
  const TemporaryFolder folder;
  EXPECT_THAT(usage_error_of([&] {
                load_plan(folder, std::string(kStudyHead) +
                                      "[[optimizer]]\nname = 'ga'\nlabel = 'neural'\n"
                                      "set = ['control.controller=neural']\n");
              }),
              HasSubstr("optimizer neural on sphere: --set control.controller=neural: unknown key "
                        "control"));
}

TEST(StudyPlan, FreshCasesAreForOptimizersWithGenerationsOnly) {
  StudyRequest request = make_small_request();
  request.schedule = Schedule{.kind = Schedule::Kind::fresh, .cases = 1};
  EXPECT_THAT(
      usage_error_of([&] { make_study_plan(request); }),
      HasSubstr("only optimizers with generations can be compared on it, and these have none: "
                "start, random, nlopt:neldermead"));
  request.baselines = false;
  EXPECT_TRUE(make_study_plan(request).problems.front().schedule.changes_cases());
}

TEST(StudyPlan, CoevolvedCasesAreInSetsOfTheirOwn) {
  StudyRequest request = make_small_request();
  request.problems = {"q1-complex"};
  request.settings = {"physics.engine=articulated", "sets.test_cases=3", "sets.validation_cases=3"};
  request.optimizers = {"ga"};
  request.baselines = false;
  request.schedule = Schedule{.kind = Schedule::Kind::coevolution, .cases = 4};
  const StudyPlan plan = make_study_plan(request);
  std::set<std::string> hashes;
  int training = 0;
  for (const UsedSet& set : list_used_sets(plan)) {
    hashes.insert(set.sha256);
    if (set.role == "training") {
      ++training;
      EXPECT_THAT(set.name, testing::StartsWith("coevolved/study-"));
      EXPECT_EQ(set.cases, 4);
    }
  }
  EXPECT_EQ(training, plan.replicates);
  EXPECT_EQ(hashes.size(), list_used_sets(plan).size());
}

TEST(StudyPlan, ARaceIsASettingOfTheProblem) {
  StudyRequest request = make_small_request();
  request.settings = {"racing.kind=halving", "racing.first_cases=2"};
  request.schedule = Schedule{.kind = Schedule::Kind::fixed, .cases = 5};
  const StudyPlan plan = make_study_plan(request);
  for (const Cell& cell : list_cells(plan)) {
    EXPECT_EQ(to_text(make_run_plan(plan, cell).racing), "halving:2:2");
  }
  const TemporaryFolder folder;
  const std::string key =
      "problems = ['sphere']\nbudget = 100\n[[optimizer]]\nname = "
      "'ga'\nracing = 'halving'\n";
  EXPECT_THAT(usage_error_of([&] { load_plan(folder, key); }),
              HasSubstr("mine.toml:5: unknown key optimizer[0].racing"));
}

TEST(StudyPlan, AReplicateGivesEveryOptimizerTheSameStartAndCases) {
  StudyRequest request = make_small_request();
  request.problems = {"q1-complex"};
  request.settings = {"physics.engine=articulated", "sets.test_cases=3", "sets.validation_cases=3"};
  const StudyPlan plan = make_study_plan(request);
  std::set<std::uint64_t> seeds;
  std::set<double> starts;
  std::set<std::string> sets;
  for (const Cell& cell : list_cells(plan)) {
    const RunPlan run = make_run_plan(plan, cell);
    const RunPlan first = make_run_plan(plan, {cell.problem, 0, cell.replicate});
    const auto& variables = run.problem.problem->description().variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      EXPECT_EQ(variables[i].start, first.problem.problem->description().variables[i].start);
      EXPECT_GE(variables[i].start, variables[i].lower);
      EXPECT_LE(variables[i].start, variables[i].upper);
    }
    EXPECT_EQ(run.problem.sets.training, first.problem.sets.training);
    EXPECT_EQ(run.budget, plan.budget);
    EXPECT_EQ(run.schedule.cases, first.schedule.cases);
    seeds.insert(run.seed);
    starts.insert(variables.front().start);
    sets.insert(run.problem.sets.training);
  }
  EXPECT_EQ(seeds.size(), list_cells(plan).size());  // one random stream per cell
  EXPECT_EQ(starts.size(), 6u);                      // one start per replicate
  EXPECT_EQ(sets.size(), 6u);                        // one training set per replicate
}

TEST(StudyPlan, SetsHaveNoCaseInCommonAndAreNamedByHash) {
  StudyRequest request = make_small_request();
  request.problems = {"q1-complex"};
  request.settings = {"sets.test_cases=3", "sets.validation_cases=3"};
  const auto sets = list_used_sets(make_study_plan(request));
  std::set<std::string> hashes;
  for (const UsedSet& set : sets) {
    EXPECT_EQ(set.sha256.size(), 64u);
    hashes.insert(set.sha256);
  }
  EXPECT_EQ(hashes.size(), 2u + 6u);  // test, validation, one training set per replicate
}

TEST(StudyPlan, TheResolvedPlanReadsBackAsItself) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string(kStudyHead) + R"(
optimizers = ["random"]
[[optimizer]]
name = "ga"
label = "ga, \"small\" \\ ü"
options = ["population=8"]
)");
  std::ofstream(folder / "resolved.toml") << to_toml(plan);
  StudyRequest request;
  request.file = (folder / "resolved.toml").string();
  EXPECT_EQ(to_toml(make_study_plan(request)), to_toml(plan));
}

// The plan was made on another machine, where "auto" chose the lowest level.
TEST(StudyPlan, IsReadBackOnTheSimdLevelThatItWasMadeWith) {
  StudyRequest request;
  request.problems = {"q1-complex"};
  request.optimizers = {"cmaes"};
  request.settings = {"physics.engine=articulated", "physics.simd=scalar"};
  request.replicates = 2;
  request.budget = 40;
  const StudyPlan made = make_study_plan(request);
  std::string toml = to_toml(made);
  toml.erase(0, toml.find('\n') + 1);  // the line with the hash of the following text
  const std::string setting = ", \"physics.simd=scalar\"";
  ASSERT_NE(toml.find(setting), std::string::npos);
  toml.erase(toml.find(setting), setting.size());
  const TemporaryFolder folder;
  const StudyPlan read = load_plan(folder, toml);
  EXPECT_EQ(calc_configuration_hash(read.problems[0].loaded),
            calc_configuration_hash(made.problems[0].loaded));
  toml.replace(toml.find("configuration_sha256 = \"") + 24, 4, "0000");
  EXPECT_THAT(usage_error_of([&] { load_plan(folder, toml); }),
              HasSubstr("is not the one that the plan was made with"));
}

TEST(StudyPlan, CheckpointsAreWholeEvaluationsUpToTheBudget) {
  EXPECT_THAT(calc_checkpoints(1, 2000, 5, 4), ElementsAre(5, 35, 270, 2000));
  EXPECT_THAT(calc_checkpoints(1, 12, 5, 20), ElementsAre(5, 10));
  EXPECT_THAT(calc_checkpoints(1, 7, 1, 1), ElementsAre(7));
  EXPECT_THAT(calc_checkpoints(500, 4000, 5, 4), ElementsAre(500, 1000, 2000, 4000));
  EXPECT_THAT(calc_checkpoints(2000, 2000, 5, 4), ElementsAre(2000));
  EXPECT_THAT(calc_checkpoints(2000, 160, 5, 4), ElementsAre(160));
}

TEST(StudyPlan, NamesOfFilesAreNeverAlikeHiddenOrElsewhere) {
  EXPECT_EQ(escape_name("nlopt:cobyla"), "nlopt%3Acobyla");
  EXPECT_EQ(escape_name("../x"), "%2E.%2Fx");
  EXPECT_EQ(escape_name("a%3A"), "a%253A");
}

// A plan's selection as (last, best, most).
std::vector<int> list_selection(const StudyPlan& plan) {
  return {plan.selection.last, plan.selection.best, plan.selection.most};
}

constexpr const char* kPlainStudy = R"(problems = ["sphere"]
optimizers = ["ga", "cmaes"]
budget = 100
set = ["function.dimension=2"]
)";

TEST(StudySelection, EveryRunHasNinePlacesUnlessTheFileSaysOtherwise) {
  const TemporaryFolder folder;
  const std::string plain = kPlainStudy;
  EXPECT_EQ(list_selection(load_plan(folder, plain)), (std::vector{9, 5, 9}));
  EXPECT_EQ(list_selection(load_plan(folder, plain + "[selection]\nmost = 4\n")),
            (std::vector{9, 5, 4}));
  EXPECT_EQ(list_selection(load_plan(folder, plain + "[selection]\nlast = 20\nbest = 3\n")),
            (std::vector{20, 3, 23}));
  EXPECT_EQ(list_selection(load_plan(folder, to_toml(load_plan(folder, plain)))),
            (std::vector{9, 5, 9}));
}

TEST(StudySelection, IsTheSameForEveryOptimizerWhereAFrontIsJudged) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(
      folder, "problems = [\"constrained\"]\noptimizers = [\"ga\", \"cmaes\"]\nbudget = 100\n");
  const Selection selection = choose_selection(plan, plan.problems[0]);
  EXPECT_EQ(selection.most, 45);
  EXPECT_EQ(selection.last + selection.best, 45);
}

}  // namespace
}  // namespace armwright
