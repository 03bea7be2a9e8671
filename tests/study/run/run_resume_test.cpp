// Tests runs that are interrupted, repeated or changed by somebody: they resume to the same result,
// or say why they cannot.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/expect_error.hpp"
#include "base/remove_checksums.hpp"
#include "problems/lanes_engine.hpp"
#include "study/run/run.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(RunTest, ARunStoppedEveryFewCasesEndsAsAnUninterruptedOne) {
  for (const std::string optimizer : {"ga", "random"}) {
    const std::string whole = optimizer + "-whole";
    const std::string pieces = optimizer + "-pieces";
    run(make_small_plan(optimizer), whole);
    int starts = 0;
    for (bool done = false; !done; ++starts) {
      ASSERT_LT(starts, 100);
      StopSignal stop;
      StoppingObserver observer(stop, 5);
      done = execute_run({make_small_plan(optimizer), temporary_ / pieces, 2, {}}, stop, observer)
                 .has_value();
    }
    EXPECT_GT(starts, 5) << "the run was never interrupted";
    expect_same_evaluations(read(whole), read(pieces));
    EXPECT_EQ(read_result(whole), read_result(pieces)) << optimizer;
  }
}

TEST_F(RunTest, ATimeLimitStopsResumably) {
  StopSignal stop;
  stop.set_deadline(StopSignal::Clock::now());
  EXPECT_FALSE(execute_run({make_small_plan(), temporary_ / "a", 2, {}}, stop, observer_));
  EXPECT_EQ(stop.reason(), StopReason::time_limit);
  EXPECT_TRUE(run(make_small_plan(), "a"));
}

TEST_F(RunTest, ACompleteRunIsShownAndNotRunAgain) {
  const auto first = run(make_small_plan(), "a");
  const auto size = std::filesystem::file_size(temporary_ / "a" / "journal");
  const auto second = run(make_small_plan(), "a");
  ASSERT_TRUE(first && second);
  EXPECT_EQ(to_json(*first), to_json(*second));
  EXPECT_EQ(std::filesystem::file_size(temporary_ / "a" / "journal"), size);
  EXPECT_THAT(observer_.messages.back(), HasSubstr("this run is complete; use --new"));
}

TEST_F(RunTest, TheResultIsRebuiltFromTheJournal) {
  run(make_small_plan(), "a");
  const std::string before = read_result("a");
  const auto size = std::filesystem::file_size(temporary_ / "a" / "journal");
  for (const auto* file : {"result.json", "winner.toml", "results.sqlite"}) {
    std::filesystem::remove(temporary_ / "a" / file);
  }
  const auto again = run(make_small_plan(), "a");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->counts.replayed, again->counts.evaluations);
  EXPECT_EQ(read_result("a"), before);
  EXPECT_EQ(std::filesystem::file_size(temporary_ / "a" / "journal"), size);
}

TEST_F(RunTest, ARemovedTableIsRebuiltThoughTheResultIsThere) {
  run(make_small_plan(), "a");
  for (const auto* file : {"results.sqlite", "winner-trajectory.csv"}) {
    std::filesystem::remove(temporary_ / "a" / file);
    ASSERT_TRUE(run(make_small_plan(), "a"));
    EXPECT_TRUE(std::filesystem::exists(temporary_ / "a" / file)) << file;
  }
}

TEST_F(RunTest, ATornJournalIsMendedAndTheRunGoesOn) {
  run(make_small_plan(), "whole");
  run(make_small_plan(), "torn");
  std::filesystem::remove(temporary_ / "torn" / "result.json");
  const auto journal = temporary_ / "torn" / "journal";
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) / 2);
  ASSERT_TRUE(run(make_small_plan(), "torn"));
  expect_same_evaluations(read("whole"), read("torn"));
  EXPECT_EQ(read_result("whole"), read_result("torn"));
}

TEST_F(RunTest, ADamagedManifestOrResultIsNamed) {
  run(make_small_plan(), "a");
  const std::string result = read_result("a");
  std::ofstream(temporary_ / "a" / "result.json") << "{}";
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make_small_plan(), "a"); }),
              HasSubstr("result.json: was changed after it was written"));
  // Without checksums the run is made again from its journal, so the result is not read.
  remove_checksums(temporary_ / "a");
  EXPECT_TRUE(run(make_small_plan(), "a"));
  EXPECT_EQ(read_result("a"), result);
  std::ofstream(temporary_ / "a" / "manifest.json") << "{";
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make_small_plan(), "a"); }),
              HasSubstr("manifest.json: was changed after it was written"));
  remove_checksums(temporary_ / "a");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make_small_plan(), "a"); }),
              HasSubstr("manifest.json: is not a manifest that armwright wrote"));
}

TEST_F(RunTest, AFolderWithOtherFilesIsLeftAlone) {
  std::filesystem::create_directories(temporary_ / "mine");
  std::ofstream(temporary_ / "mine" / "winner.toml") << "precious";
  EXPECT_THAT(
      usage_error_of([&] { run(make_small_plan(), "mine"); }),
      HasSubstr("mine: holds 'winner.toml' but no manifest.json, so it is not the folder of "
                "a run; choose another folder with --out"));
  EXPECT_EQ(read_file(temporary_ / "mine" / "winner.toml", 100), "precious");
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "mine" / "lock"));
}

TEST_F(RunTest, AJournalWithMoreThanIsAskedForIsRefused) {
  run(make_small_plan("ga", 40), "long");
  run(make_small_plan("ga", 24), "short");
  std::filesystem::remove(temporary_ / "short" / "result.json");
  std::filesystem::copy_file(temporary_ / "long" / "journal", temporary_ / "short" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(
      error_of(ErrorKind::bad_data, [&] { run(make_small_plan("ga", 24), "short"); }),
      HasSubstr("evaluation 24 of the journal is not what optimizer 'ga' asks for now: it is "
                "recorded, and no longer asked for"));
}

TEST_F(RunTest, AnEndedJournalIsNotContinued) {
  run(make_small_plan("ga", 24), "short");
  run(make_small_plan("ga", 40), "long");
  std::filesystem::remove(temporary_ / "long" / "result.json");
  std::filesystem::copy_file(temporary_ / "short" / "journal", temporary_ / "long" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make_small_plan("ga", 40), "long"); }),
              HasSubstr("the recorded run had ended before it"));
}

TEST_F(RunTest, AnotherConfigurationIsRefusedWithTheDifference) {
  run(make_small_plan(), "a");
  RunPlan other = make_small_plan();
  other.budget = 48;
  other.problem = load_problem(
      "q1-complex", std::vector<std::string>{"workspace.points=4", "sets.validation_cases=3",
                                             "sets.test_cases=4", "task.speed_m_per_s=2"});
  EXPECT_THAT(
      usage_error_of([&] { run(other, "a"); }),
      AllOf(HasSubstr("holds a run with another configuration"),
            HasSubstr("run.budget: recorded 40, now 48"),
            HasSubstr("problem.task.speed_m_per_s: recorded 1.5, now 2"), HasSubstr("--new")));
}

// A difference that follows from another one is not listed.
TEST_F(RunTest, ARefusalNamesTheCommandAndEachDifferenceOnce) {
  const auto make_plan = [](const std::string& engine, const char* budget) {
    RunPlan plan = make_small_plan();
    plan.budget = std::stoll(budget);
    plan.problem =
        load_problem("q1-complex",
                     std::vector<std::string>{"workspace.points=4", "sets.validation_cases=3",
                                              "sets.test_cases=4", "physics.engine=" + engine,
                                              "run.budget=" + std::string(budget)},
                     engines_with_lanes());
    return plan;
  };
  run(make_plan("lanes", "40"), "a");
  const auto manifest = temporary_ / "a" / "manifest.json";
  nlohmann::json content = nlohmann::json::parse(read_file(manifest, 1 << 24));
  content["command_line"] = {"armwright", "optimize", "my problem"};
  remove_checksums(temporary_ / "a");
  std::ofstream(manifest, std::ios::binary) << content;
  EXPECT_THAT(
      usage_error_of([&] { run(make_plan("ode", "48"), "a"); }),
      AllOf(HasSubstr("problem.physics.engine: recorded \"lanes\", now \"ode\""),
            HasSubstr("run.budget: recorded 40, now 48"),
            HasSubstr("The run was begun or continued with:\n  armwright optimize 'my problem'\n"),
            testing::Not(HasSubstr("simd")), testing::Not(HasSubstr("problem.run.budget"))));
}

// Results differ in the last bits between SIMD levels, so a run keeps the level it began with.
TEST_F(RunTest, AnotherSimdLevelIsRefusedWithWhatToDo) {
  const auto make_plan = [](const std::string& simd) {
    RunPlan plan = make_small_plan();
    plan.problem =
        load_problem("q1-complex",
                     std::vector<std::string>{"workspace.points=4", "sets.validation_cases=3",
                                              "sets.test_cases=4", "physics.engine=lanes",
                                              "physics.simd=" + simd},
                     engines_with_lanes());
    return plan;
  };
  const std::string best = to_string(find_best_simd());
  ASSERT_NE(best, "scalar") << "every machine that this is built for has more";
  run(make_plan("auto"), "a");
  EXPECT_TRUE(run(make_plan(best), "a")) << "auto is " << best << " here";
  EXPECT_THAT(usage_error_of([&] { run(make_plan("scalar"), "a"); }),
              AllOf(HasSubstr("problem.physics.simd: recorded \"" + best + "\", now \"scalar\""),
                    HasSubstr("to resume this run, pass --simd " + best)));
  // As if the folder came from another machine.
  const auto manifest = temporary_ / "a" / "manifest.json";
  std::string text = read_file(manifest, 1 << 24);
  const std::string recorded = "\"simd\": \"" + best + "\"";
  ASSERT_NE(text.find(recorded), std::string::npos);
  text.replace(text.find(recorded), recorded.size(), "\"simd\": \"avx8192\"");
  remove_checksums(temporary_ / "a");
  std::ofstream(manifest, std::ios::binary) << text;
  EXPECT_THAT(usage_error_of([&] { run(make_plan("auto"), "a"); }),
              HasSubstr("this CPU lacks avx8192; resume the run on a machine that has it"));
}

TEST_F(RunTest, ResultsOfBatchesDoNotDependOnTheNumberOfThreads) {
  RunPlan plan = make_small_plan();
  plan.problem =
      load_problem("q1-complex",
                   std::vector<std::string>{"workspace.points=4", "sets.validation_cases=7",
                                            "sets.test_cases=90", "physics.engine=lanes"},
                   engines_with_lanes());
  run(plan, "one", 1);
  run(plan, "three", 3);
  expect_same_evaluations(read("one"), read("three"));
  EXPECT_EQ(read_result("one"), read_result("three"));
}

TEST_F(RunTest, AReplayThatDiffersNamesTheEvaluation) {
  run(make_small_plan(), "a");
  std::filesystem::remove(temporary_ / "a" / "result.json");
  // The journal of another seed under this run's manifest, as if another version of the optimizer
  // had written it.
  RunPlan other = make_small_plan();
  other.seed = 7;
  run(other, "b");
  std::filesystem::copy_file(temporary_ / "b" / "journal", temporary_ / "a" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(
      error_of(ErrorKind::bad_data, [&] { run(make_small_plan(), "a"); }),
      AllOf(HasSubstr("evaluation 0 of the journal is not what optimizer 'ga' asks for now"),
            HasSubstr("joint_1."), HasSubstr("start a new run with --new")));
}

}  // namespace
}  // namespace armwright
