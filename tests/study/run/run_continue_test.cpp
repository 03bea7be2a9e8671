// Tests runs that are continued with a larger budget: they end with the bytes of a run that had it
// from the beginning, or say why they cannot go on.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/expect_error.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kSmall = 60, kLarge = 150;

class ContinuedRun : public RunTest {
 protected:
  // Constraints for those that can have them, and residuals for those that need them.
  static RunPlan make_plan(const std::string& optimizer, std::int64_t budget) {
    RunPlan plan;
    plan.optimizer = load_optimizer(optimizer);
    const bool has_front = plan.optimizer.requirements.objectives > 1;
    plan.problem = load_problem(has_front ? "zdt1" : "rosenbrock");
    plan.options = Options::parse(optimizer, plan.optimizer.options, {});
    plan.budget = budget;
    plan.schedule = choose_schedule(plan.problem, plan.optimizer);
    return plan;
  }
  json read_manifest_of(const std::string& folder) {
    return json::parse(read_file(temporary_ / folder / "manifest.json", 1 << 24));
  }
  void expect_same_files(const std::string& a, const std::string& b) {
    for (const std::string& name : derived_file_names()) {
      const bool is_there = std::filesystem::exists(temporary_ / a / name);
      ASSERT_EQ(is_there, std::filesystem::exists(temporary_ / b / name)) << name;
      if (is_there) {
        EXPECT_TRUE(read_file(temporary_ / a / name, 1 << 24) ==
                    read_file(temporary_ / b / name, 1 << 24))
            << name << " of " << a << " and " << b;
      }
    }
    expect_same_evaluations(read(a), read(b));
    EXPECT_TRUE(read(b).ended);
    json recorded = read_manifest_of(a);
    EXPECT_EQ(recorded["configuration"], read_manifest_of(b)["configuration"]);
  }
};

TEST_F(ContinuedRun, EndsAsOneThatHadTheLargerBudgetFromTheBeginning) {
  for (const std::string optimizer :
       {"ga", "cmaes", "nlopt:cobyla", "random", "turbo", "dfls", "lhs", "mode", "nlopt:neldermead",
        "multistart:nlopt:bobyqa", "pagmo:de", "pagmo:sade", "pagmo:nsga2"}) {
    SCOPED_TRACE(optimizer);
    const std::string name = make_run_name(make_plan(optimizer, kSmall));
    ASSERT_TRUE(run(make_plan(optimizer, kLarge), name + "-whole"));
    ASSERT_TRUE(run(make_plan(optimizer, kSmall), name));
    ASSERT_TRUE(read(name).ended);
    ASSERT_TRUE(run(make_plan(optimizer, kLarge), name));
    expect_same_files(name + "-whole", name);
    EXPECT_THAT(observer_.messages, Contains("continuing with a budget of 150 in place of 60"));
  }
}

TEST_F(ContinuedRun, OfAnArmWithCasesThatChangeEndsInTheSameWay) {
  for (const Schedule::Kind kind :
       {Schedule::Kind::fresh, Schedule::Kind::fixed, Schedule::Kind::coevolution}) {
    const auto make = [&](std::int64_t budget) {
      RunPlan plan = make_small_plan("ga", budget);
      plan.schedule = {.kind = kind, .cases = 4};
      return plan;
    };
    const std::string name = to_string(kind);
    ASSERT_TRUE(run(make(160), name + "-whole"));
    ASSERT_TRUE(run(make(70), name));  // the budget ends within a generation
    ASSERT_TRUE(run(make(160), name));
    expect_same_files(name + "-whole", name);
  }
}

TEST_F(ContinuedRun, MayHaveBeenInterruptedAndMayBeInterruptedAgain) {
  for (const std::string optimizer : {"ga", "cmaes", "nlopt:cobyla"}) {
    SCOPED_TRACE(optimizer);
    const std::string name = make_run_name(make_plan(optimizer, kSmall));
    ASSERT_TRUE(run(make_plan(optimizer, kLarge), name + "-whole"));
    const auto run_some = [&](std::int64_t budget, std::uint64_t cases) {
      StopSignal stop;
      StoppingObserver observer(stop, cases);
      return execute_run({make_plan(optimizer, budget), temporary_ / name, 2, {}}, stop, observer);
    };
    ASSERT_FALSE(run_some(kSmall, 20));
    ASSERT_FALSE(run_some(100, 20));
    ASSERT_FALSE(std::filesystem::exists(temporary_ / name / "result.json"));
    ASSERT_TRUE(run(make_plan(optimizer, 100), name));
    int starts = 0;
    while (!run_some(kLarge, 20)) {
      ASSERT_LT(++starts, 20);
    }
    EXPECT_GT(starts, 0) << "it was never interrupted";
    expect_same_files(name + "-whole", name);
  }
}

TEST_F(ContinuedRun, ThatStopsBeforeAnythingNewStaysAsItWas) {
  ASSERT_TRUE(run(make_plan("ga", kSmall), "a"));
  const std::string result = read_result("a");
  const std::string sums = read_file(temporary_ / "a" / "SHA256SUMS", 1 << 20);
  StopSignal stop;
  stop.request(StopReason::interrupted);
  EXPECT_FALSE(execute_run({make_plan("ga", kLarge), temporary_ / "a", 2, {}}, stop, observer_));
  EXPECT_EQ(read_result("a"), result);
  EXPECT_EQ(read_file(temporary_ / "a" / "SHA256SUMS", 1 << 20), sums);
  EXPECT_EQ(read_manifest_of("a")["configuration"]["run"]["budget"], kSmall);
  observer_.messages.clear();
  ASSERT_TRUE(run(make_plan("ga", kSmall), "a"));
  EXPECT_THAT(observer_.messages,
              Contains(HasSubstr("this run is complete; use --new for another one, or continue it "
                                 "with a larger --budget")));
}

// A kill before the manifest is replaced leaves this: the command of the smaller budget still works,
// and so does that of the larger one.
TEST_F(ContinuedRun, KilledBeforeTheManifestIsARunOfTheSmallerBudget) {
  ASSERT_TRUE(run(make_plan("cmaes", kSmall), "small"));
  ASSERT_TRUE(run(make_plan("cmaes", kLarge), "large"));
  ASSERT_TRUE(run(make_plan("cmaes", kSmall), "a"));
  std::filesystem::remove(temporary_ / "a" / "SHA256SUMS");
  std::filesystem::remove(temporary_ / "a" / "result.json");
  {
    JournalContent content;
    Journal journal(temporary_ / "a" / "journal", content);
    EXPECT_TRUE(content.ended);
    journal.append(ContinueRecord{kLarge, content.training.size()});
  }
  EXPECT_FALSE(read("a").ended);
  ASSERT_TRUE(run(make_plan("cmaes", kSmall), "a"));
  expect_same_files("small", "a");
  ASSERT_TRUE(run(make_plan("cmaes", kLarge), "a"));
  expect_same_files("large", "a");
}

TEST_F(ContinuedRun, ThatHadFinishedByItselfCountsItsUnusedEvaluationsAnew) {
  const auto make = [&](std::int64_t budget) {
    RunPlan plan = make_plan("nlopt:cobyla", budget);
    plan.problem = load_problem("sphere", std::vector<std::string>{"function.dimension=2"});
    plan.options = Options::parse("nlopt:cobyla", plan.optimizer.options,
                                  std::vector<std::string>{"xtol_rel=0.1"});
    return plan;
  };
  const auto whole = run(make(4000), "whole");
  const auto begun = run(make(2000), "a");
  ASSERT_TRUE(whole && begun);
  ASSERT_GT(begun->unused_evaluations, 0);
  const auto continued = run(make(4000), "a");
  ASSERT_TRUE(continued);
  EXPECT_EQ(continued->unused_evaluations, begun->unused_evaluations + 2000);
  expect_same_files("whole", "a");
}

TEST_F(ContinuedRun, NeedsALargerBudget) {
  ASSERT_TRUE(run(make_plan("ga", kSmall), "a"));
  EXPECT_THAT(usage_error_of([&] { run(make_plan("ga", kSmall - 1), "a"); }),
              AllOf(HasSubstr("run.budget: recorded 60, now 59"),
                    HasSubstr("A larger budget can continue a run, and a smaller one cannot")));
  RunPlan other = make_plan("ga", kLarge);
  other.seed = 2;
  EXPECT_THAT(usage_error_of([&] { run(other, "a"); }),
              AllOf(HasSubstr("run.seed: recorded 1, now 2"), Not(HasSubstr("larger budget"))));
}

TEST_F(ContinuedRun, NeedsAnOptimizerScheduleAndRacingThatDoNotPlanWithTheBudget) {
  const auto refusal = [&](const auto& make) {
    const std::string name = "a" + std::to_string(std::distance(
                                       std::filesystem::directory_iterator(temporary_ / ""), {}));
    EXPECT_TRUE(run(make(kSmall), name));
    const std::string result = read_result(name);
    const std::string refused = usage_error_of([&] { run(make(kLarge), name); });
    EXPECT_EQ(read_result(name), result);
    return refused;
  };
  EXPECT_THAT(refusal([&](auto budget) { return make_plan("pagmo:gwo", budget); }),
              HasSubstr("The larger budget does not continue this run: optimizer 'pagmo:gwo' plans "
                        "with the whole budget"));
  const auto make_racing = [&](const char* optimizer, std::int64_t budget) {
    RunPlan plan = make_small_plan(optimizer, budget);
    plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 4};
    plan.racing = {.kind = Racing::Kind::halving, .first_cases = 2};
    return plan;
  };
  EXPECT_THAT(refusal([&](auto budget) { return make_racing("ga", budget); }),
              HasSubstr("racing halving:2:2 lets as many candidates compete as the rest"));
  EXPECT_THAT(refusal([&](auto budget) {
                RunPlan plan = make_small_plan("ga", budget);
                plan.schedule = {.kind = Schedule::Kind::growing, .cases = 2, .factor = 2};
                return plan;
              }),
              HasSubstr("with schedule growing:2:2 the number of cases grows only while"));
  EXPECT_THAT(explain_no_continuation(make_racing("nlopt:cobyla", kSmall)), testing::IsEmpty());
}

// An optimizer that does not say that it plans with the budget.
class Undeclared : public Optimizer {
 public:
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    const double step = 1.0 / static_cast<double>(evaluator.remaining());
    std::vector<double> x(evaluator.problem().variables.size(), 0);
    while (!evaluator.stopped()) {
      x[0] += step;
      evaluator.evaluate(std::vector<std::vector<double>>{x});
    }
  }
};

TEST_F(ContinuedRun, ThatDoesNotReplayIsRefusedAndStaysAsItWas) {
  const auto make = [&](std::int64_t budget) {
    RunPlan plan = make_plan("random", budget);
    plan.optimizer = OptimizerRow();
    plan.optimizer.name = "undeclared";
    plan.optimizer.make = [](const Options&) { return std::make_unique<Undeclared>(); };
    plan.options = {};
    return plan;
  };
  const auto first = run(make(kSmall), "a");
  ASSERT_TRUE(first);
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make(kLarge), "a"); }),
              AllOf(HasSubstr("evaluation 0 of the journal is not what optimizer 'undeclared' asks "
                              "for now"),
                    HasSubstr("With the larger budget it searches otherwise from the beginning"),
                    HasSubstr("The run stays as it was")));
  const auto again = run(make(kSmall), "a");
  ASSERT_TRUE(again);
  EXPECT_EQ(to_json(*again), to_json(*first));
}

class Failing : public Optimizer {
 public:
  void minimize(Evaluator& /*evaluator*/, std::uint64_t /*seed*/) override {
    throw OptimizerFailure("no licence");
  }
};

TEST_F(ContinuedRun, WhoseOptimizerFailsAtOnceStaysAsItWas) {
  ASSERT_TRUE(run(make_plan("random", kSmall), "a"));
  const std::string result = read_result("a");
  RunPlan plan = make_plan("random", kLarge);
  plan.optimizer.make = [](const Options&) { return std::make_unique<Failing>(); };
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(plan, "a"); }),
              HasSubstr("so the run stays as it was with a budget of 60"));
  EXPECT_EQ(read_result("a"), result);
}

// Recommends what it found at the end of the budget.
class Recommending : public Optimizer {
 public:
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    std::vector<double> x(evaluator.problem().variables.size(), 1.5);
    while (!evaluator.stopped()) {
      x[0] *= 0.99;
      evaluator.evaluate(std::vector<std::vector<double>>{x});
    }
    x[1] = x[0] * x[0];
    evaluator.recommend(x);
  }
};

TEST_F(ContinuedRun, JudgesNoRecommendationAfterTheSmallerBudget) {
  const auto make = [&](std::int64_t budget) {
    RunPlan plan = make_plan("random", budget);
    plan.optimizer = OptimizerRow();
    plan.optimizer.name = "recommending";
    plan.optimizer.make = [](const Options&) { return std::make_unique<Recommending>(); };
    plan.options = {};
    return plan;
  };
  ASSERT_TRUE(run(make(kLarge), "whole"));
  ASSERT_TRUE(run(make(kSmall), "a"));
  ASSERT_TRUE(read("a").late.has_value());
  ASSERT_TRUE(run(make(kLarge), "a"));
  expect_same_files("whole", "a");
  EXPECT_EQ(read("a").late->x, read("whole").late->x);
}

class ContinuedAuto : public ContinuedRun {
 protected:
  // Rules that choose by the number of evaluations.
  RunPlan make_auto_plan(std::int64_t budget, const std::vector<std::string>& more = {}) {
    RunPlan plan = make_plan("auto", budget);
    const auto file = temporary_ / "rules.toml";
    write_file_atomically(
        file,
        "[[rule]]\nevaluations_at_most = 100\nuse = \"ga\"\nwhy = \"There are few.\"\n"
        "[[rule]]\nuse = \"cmaes\"\nwhy = \"There are many.\"\n");
    std::vector<std::string> options = {"rules=" + file.string()};
    options.insert(options.end(), more.begin(), more.end());
    plan.options = Options::parse("auto", plan.optimizer.options, options);
    return plan;
  }
};

TEST_F(ContinuedAuto, KeepsItsChoiceAndSaysSo) {
  ASSERT_TRUE(run(make_auto_plan(kSmall), "a"));
  const auto continued = run(make_auto_plan(kLarge), "a");
  ASSERT_TRUE(continued);
  const std::string kept =
      "kept ga, which auto chose for 10 variables, 1 objective, 60 evaluations and residuals. "
      "There "
      "are few.";
  EXPECT_EQ(continued->choice, kept);
  EXPECT_THAT(observer_.messages, Contains(kept));
  EXPECT_EQ(continued->counts.evaluations, 150u);
  EXPECT_EQ(read_manifest_of("a")["configuration"]["run"]["options"]["evaluations"], 60);
  // The same command shows it, and a still larger budget continues it with the first choice.
  ASSERT_TRUE(run(make_auto_plan(kLarge), "a"));
  const auto longest = run(make_auto_plan(200), "a");
  ASSERT_TRUE(longest);
  EXPECT_EQ(longest->choice, kept);
  // The recorded option repeats it from the beginning.
  ASSERT_TRUE(run(make_auto_plan(200, {"evaluations=60"}), "whole"));
  expect_same_files("whole", "a");
}

TEST_F(ContinuedAuto, EndsAsFromTheBeginningWhereTheRulesChooseTheSame) {
  ASSERT_TRUE(run(make_auto_plan(110), "a"));
  const auto continued = run(make_auto_plan(kLarge), "a");
  const auto whole = run(make_auto_plan(kLarge), "whole");
  ASSERT_TRUE(continued && whole);
  EXPECT_THAT(continued->choice, HasSubstr("auto chose cmaes for 10 variables, 1 objective, 150"));
  EXPECT_EQ(to_json(*continued), to_json(*whole));
}

TEST_F(ContinuedAuto, KeepsNoOptimizerBeyondItsLimits) {
  const auto make = [&](std::int64_t budget) {
    RunPlan plan = make_plan("auto", budget);
    const auto file = temporary_ / "rules.toml";
    write_file_atomically(
        file,
        "[[rule]]\nevaluations_at_most = 100\nuse = \"turbo\"\nwhy = \"There are few.\"\n"
        "[[rule]]\nuse = \"cmaes\"\nwhy = \"There are many.\"\n");
    plan.options = Options::parse("auto", plan.optimizer.options,
                                  std::vector<std::string>{"rules=" + file.string()});
    return plan;
  };
  ASSERT_TRUE(run(make(20), "a"));
  const std::string result = read_result("a");
  EXPECT_THAT(
      usage_error_of([&] { run(make(2001), "a"); }),
      HasSubstr("optimizer 'turbo', which auto chose, is made for at most 2000 evaluations, "
                "and the budget pays for 2001"));
  EXPECT_EQ(read_result("a"), result);
}

TEST(FolderName, ShowsWhatTheUserHasSet) {
  const auto name = [](const std::string& optimizer, const std::vector<std::string>& settings,
                       const std::vector<std::string>& options = {},
                       std::optional<Schedule> schedule = {}) {
    RunPlan plan;
    plan.problem = load_problem("q1-complex");
    plan.optimizer = load_optimizer(optimizer);
    plan.options = Options::parse(optimizer, plan.optimizer.options, options);
    plan.budget = 1000;
    plan.schedule = schedule.value_or(choose_schedule(plan.problem, plan.optimizer));
    return make_folder_name(plan, settings);
  };
  EXPECT_EQ(name("ga", {}), "q1-complex-ga-seed1");
  EXPECT_EQ(name("ga", {"physics.substeps=2"}), "q1-complex-ga-seed1-substeps2");
  EXPECT_EQ(name("ga", {" physics.engine = \"ode\" "}), "q1-complex-ga-seed1-engine_ode");
  EXPECT_EQ(name("nlopt:cobyla", {}), "q1-complex-nlopt-cobyla-seed1");
  EXPECT_EQ(name("ga", {"physics.engine=articulated", "task.ik_bug=false"}),
            "q1-complex-ga-seed1-engine_articulated-ik_bug_false");
  EXPECT_EQ(name("ga", {"task.ik_bug=false", "physics.engine=articulated"}),
            name("ga", {"physics.engine=articulated", "task.ik_bug=false"}));
  EXPECT_EQ(name("ga", {}, {"population=50"}), "q1-complex-ga-seed1-population50");
  EXPECT_EQ(name("ga", {}, {"population=35"}), "q1-complex-ga-seed1") << "that is the default";
  EXPECT_EQ(name("ga", {}, {}, Schedule{.kind = Schedule::Kind::fixed, .cases = 10}),
            "q1-complex-ga-seed1-fixed10");
  EXPECT_EQ(name("ga", {}, {}, Schedule{.kind = Schedule::Kind::growing, .cases = 5, .factor = 2}),
            "q1-complex-ga-seed1-growing5-2");
  EXPECT_EQ(name("ga", {"robot.base=base_link", "robot.tip=tool0"}),
            "q1-complex-ga-seed1-base_base_link-tip_tool0");
}

// Eight digits stand for what would be long, ambiguous or unfit for a path.
TEST(FolderName, DiffersForDifferentSettings) {
  RunPlan plan;
  plan.problem = load_problem("q1-complex");
  plan.optimizer = load_optimizer("ga");
  plan.options = Options::parse("ga", plan.optimizer.options, {});
  plan.schedule = choose_schedule(plan.problem, plan.optimizer);
  const std::vector<std::vector<std::string>> all = {
      {},
      {"task.load_kg=20"},
      {"task.load_kg=2.0"},
      {"task.load_kg=-20"},
      {"task.home=[0.3, 0.9]"},
      {"task.home=[0.3, 0.8]"},
      {"robot.plant=a/b.toml"},
      {"robot.plant=a-b.toml"},
      {"start.x=bandwidth_rad_per_s5"},
      {"sets.validation_cases=10", "sets.test_cases=20", "workspace.points=40", "task.load_kg=2"},
      {"sets.validation_cases=10", "sets.test_cases=21", "workspace.points=40", "task.load_kg=2"},
  };
  std::set<std::string> names;
  for (const auto& settings : all) {
    const std::string name = make_folder_name(plan, settings);
    EXPECT_THAT(name, testing::MatchesRegex("q1-complex-ga-seed1(-[A-Za-z0-9._-]+)?"));
    EXPECT_LE(name.size(), std::string("q1-complex-ga-seed1").size() + 40);
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_THAT(make_folder_name(plan, all[9]),
              testing::MatchesRegex("q1-complex-ga-seed1-[0-9a-f]{8}"));
  plan.seed = 2;
  EXPECT_EQ(make_folder_name(plan, {}), "q1-complex-ga-seed2");
}

}  // namespace
}  // namespace armwright
