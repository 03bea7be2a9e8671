// Whole runs in one process: exact budgets, schedules, results that depend on neither threads nor
// interruptions, refusals.
#include "study/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "study/judge.hpp"
#include "study/run_folder.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RunTest : public testing::Test {
 protected:
  std::optional<RunResult> run(const RunPlan& plan, const std::string& folder, unsigned jobs = 2) {
    StopSignal stop;
    return execute_run({plan, temporary_ / folder, jobs, {"armwright", "optimize"}}, stop,
                       observer_);
  }
  JournalContent read(const std::string& folder) {
    return read_journal(temporary_ / folder / "journal");
  }
  std::string read_result(const std::string& folder) {
    return read_file(temporary_ / folder / "result.json", 1 << 24);
  }
  std::string error_of(const auto& work) {
    try {
      work();
    } catch (const Error& error) {
      return error.what();
    }
    return "(no error)";
  }

  TemporaryFolder temporary_;
  SilentObserver observer_;
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void expect_same_evaluations(const JournalContent& a, const JournalContent& b) {
  ASSERT_EQ(a.training.size(), b.training.size());
  for (std::size_t i = 0; i < a.training.size(); ++i) {
    EXPECT_EQ(a.training[i].index, b.training[i].index);
    EXPECT_EQ(a.training[i].generation, b.training[i].generation);
    EXPECT_EQ(a.training[i].cases.numbers, b.training[i].cases.numbers);
    EXPECT_TRUE(same_bits(a.training[i].x, b.training[i].x)) << i;
    EXPECT_TRUE(
        same_bits(a.training[i].evaluation.objectives, b.training[i].evaluation.objectives));
    EXPECT_TRUE(
        same_bits(a.training[i].evaluation.case_errors, b.training[i].evaluation.case_errors));
    EXPECT_TRUE(same_bits(a.training[i].evaluation.metrics, b.training[i].evaluation.metrics));
  }
}

TEST_F(RunTest, AFreshScheduleMovesOnWithEveryGeneration) {
  const auto result = run(make_small_plan("ga", 40), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->counts.evaluations, 40u);
  EXPECT_EQ(result->counts.cases, 40u);
  EXPECT_EQ(result->counts.generations, 5u);
  EXPECT_EQ(result->end_reason, "budget");
  for (const EvaluationRecord& record : read("a").training) {
    EXPECT_EQ(record.generation, record.index / 8 + 1);
    EXPECT_EQ(record.cases.numbers, std::vector<std::uint64_t>{record.generation - 1});
    EXPECT_EQ(record.cases.set, "train/1");
  }
}

TEST_F(RunTest, ABatchIsCutWhereTheBudgetEndsAndOnlyWholeCandidatesAreEvaluated) {
  RunPlan plan = make_small_plan("ga", 19);
  plan.schedule.cases = 2;  // 9 whole candidates of two cases; one case of the budget stays unused
  const auto result = run(plan, "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->counts.evaluations, 9u);
  EXPECT_EQ(result->counts.cases, 18u);
  EXPECT_EQ(read("a").training.size(), 9u);
}

TEST_F(RunTest, AZeroBudgetEndsWithoutAWinner) {
  const auto result = run(make_small_plan("ga", 0), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->counts.evaluations, 0u);
  EXPECT_FALSE(result->winner);
}

TEST_F(RunTest, AFixedScheduleJudgesTheImprovements) {
  const auto result = run(make_small_plan("random", 60), "a");
  ASSERT_TRUE(result && result->winner);
  double best = std::numeric_limits<double>::infinity();
  std::size_t improvements = 0;
  for (const EvaluationRecord& record : read("a").training) {
    EXPECT_EQ(record.cases.numbers, (std::vector<std::uint64_t>{0, 1}));
    if (record.evaluation.objectives.front() < best) {
      best = record.evaluation.objectives.front();
      ++improvements;
    }
  }
  EXPECT_EQ(result->judged.size(), improvements);
  EXPECT_EQ(result->judged.back().candidate.training_objective, best);
}

TEST_F(RunTest, TheWinnerIsTheBestOnTheValidationSetAndItsTestIsComplete) {
  const auto result = run(make_small_plan(), "a");
  ASSERT_TRUE(result && result->winner);
  const double winner = result->judged[*result->winner].validation.objectives.front();
  for (const JudgedCandidate& judged : result->judged) {
    EXPECT_EQ(judged.validation.case_errors.size(), 3u);
    EXPECT_LE(winner, judged.validation.objectives.front());
  }
  EXPECT_EQ(result->test.case_errors.size(), 4u);
  EXPECT_EQ(result->test_summary.cases, 4u);
  for (const auto* file : {"result.json", "winner.toml", "convergence.csv", "results.sqlite",
                           "winner-trajectory.csv", "manifest.json", "journal"}) {
    EXPECT_TRUE(std::filesystem::exists(temporary_ / "a" / file)) << file;
  }
}

TEST_F(RunTest, ResidualsAreRecordedWhereAnOptimizerMayAskForThem) {
  run(make_small_plan(), "a");
  const JournalContent journal = read("a");
  ASSERT_FALSE(journal.training.empty());
  for (const EvaluationRecord& record : journal.training) {
    EXPECT_FALSE(record.evaluation.residuals.empty()) << record.index;
  }
  ASSERT_FALSE(journal.judgements.empty());
  for (const EvaluationRecord& record : journal.judgements) {
    EXPECT_FALSE(record.evaluation.case_errors.empty()) << record.index;
    EXPECT_TRUE(record.evaluation.residuals.empty()) << record.index;
  }
}

TEST_F(RunTest, ResultsDoNotDependOnTheNumberOfThreads) {
  run(make_small_plan(), "one", 1);
  run(make_small_plan(), "two", 2);
  run(make_small_plan(), "five", 5);
  expect_same_evaluations(read("one"), read("two"));
  expect_same_evaluations(read("one"), read("five"));
  EXPECT_EQ(read_result("one"), read_result("two"));
  EXPECT_EQ(read_result("one"), read_result("five"));
}

TEST_F(RunTest, AnotherSeedIsAnotherRun) {
  RunPlan other = make_small_plan();
  other.seed = 2;
  run(make_small_plan(), "one");
  run(other, "two");
  EXPECT_FALSE(same_bits(read("one").training[0].x, read("two").training[0].x));
}

// Stops a run after a number of cases, as Ctrl-C would.
class StoppingObserver final : public SilentObserver {
 public:
  StoppingObserver(StopSignal& stop, std::uint64_t after) : stop_(stop), after_(after) {}
  void on_progress(const Progress& progress) override {
    if (progress.done - progress.replayed >= after_) {
      stop_.request(StopReason::interrupted);
    }
  }

 private:
  StopSignal& stop_;
  std::uint64_t after_;
};

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

TEST_F(RunTest, AFolderWithOtherFilesIsLeftAlone) {
  std::filesystem::create_directories(temporary_ / "mine");
  std::ofstream(temporary_ / "mine" / "winner.toml") << "precious";
  EXPECT_THAT(
      error_of([&] { run(make_small_plan(), "mine"); }),
      HasSubstr("mine: holds 'winner.toml' but no manifest.json, so it is not the folder of "
                "a run; choose another with --out"));
  EXPECT_EQ(read_file(temporary_ / "mine" / "winner.toml", 100), "precious");
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "mine" / "lock"));
}

TEST_F(RunTest, AFunctionHasNoFailuresAndNoMetres) {
  RunPlan plan;
  plan.problem = load_problem("sphere");
  plan.optimizer = load_optimizer("random");
  plan.options = Options::parse("random", plan.optimizer.options, {});
  plan.budget = 20;
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner);
  EXPECT_GT(result->test_summary.mean.value(), 1.0);
  EXPECT_EQ(result->test_summary.failures, 0u);
  EXPECT_EQ(result->counts.feasible, 20u);
}

TEST_F(RunTest, ConvergenceCountsFeasibleEvaluationsOnly) {
  RunPlan plan;
  plan.problem = load_problem("constrained");
  plan.optimizer = load_optimizer("random");
  plan.options = Options::parse("random", plan.optimizer.options, {});
  plan.budget = 2000;
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner);
  double best = 0;
  std::size_t infeasible_and_lower = 0;
  for (const EvaluationRecord& record : read("a").training) {
    if (is_feasible(record.evaluation)) {
      best = std::min(best, record.evaluation.objectives.front());
    }
  }
  for (const EvaluationRecord& record : read("a").training) {
    infeasible_and_lower += record.evaluation.objectives.front() < best ? 1 : 0;
  }
  ASSERT_GT(infeasible_and_lower, 0u) << "the test needs lower values outside";
  const std::string csv = read_file(temporary_ / "a" / "convergence.csv", 1 << 20);
  const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
  EXPECT_THAT(last, HasSubstr("," + format_exact(best) + ","));
}

// Fails after so many evaluations, unless the number is negative.
class FailingOptimizer : public Optimizer {
 public:
  explicit FailingOptimizer(int evaluations) : evaluations_(evaluations) {}
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    std::vector<double> x;
    for (const DecisionVariable& variable : evaluator.problem().variables) {
      x.push_back(variable.start);
    }
    for (int i = 0; !evaluator.stopped(); ++i) {
      if (i == evaluations_) {
        throw OptimizerFailure("it fell over");
      }
      x[0] *= 0.99;
      evaluator.evaluate({&x, 1});
    }
  }

 private:
  int evaluations_;
};

RunPlan make_failing_plan(int evaluations) {
  RunPlan plan;
  plan.problem = load_problem("sphere");
  plan.optimizer.name = "failing";
  plan.optimizer.make = [evaluations](const Options&) {
    return std::make_unique<FailingOptimizer>(evaluations);
  };
  plan.budget = 30;
  return plan;
}

TEST_F(RunTest, AFailedOptimizerEndsAMarkedRunThatKeepsEverything) {
  const auto result = run(make_failing_plan(7), "a");
  ASSERT_TRUE(result && result->winner);
  EXPECT_EQ(result->failure, "it fell over");
  EXPECT_EQ(result->end_reason, "optimizer failed");
  EXPECT_EQ(result->counts.evaluations, 7u);
  EXPECT_EQ(result->judged.size(), 7u);
  EXPECT_THAT(observer_.messages, testing::Contains("error: it fell over"));
  EXPECT_EQ(load_result(temporary_ / "a").failure, "it fell over");
  const JournalContent journal = read("a");
  EXPECT_EQ(journal.training.size(), 7u);
  EXPECT_FALSE(journal.ended);
}

TEST_F(RunTest, AFailedRunIsTriedAgainFromWhereItFailed) {
  run(make_failing_plan(7), "a");
  const auto again = run(make_failing_plan(7), "a");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->failure, "it fell over");
  EXPECT_EQ(again->counts.replayed, 7u);
  const auto repaired = run(make_failing_plan(-1), "a");
  ASSERT_TRUE(repaired);
  EXPECT_EQ(repaired->failure, "");
  EXPECT_EQ(repaired->counts.replayed, 7u);
  EXPECT_EQ(repaired->counts.evaluations, 30u);
  run(make_failing_plan(-1), "whole");
  EXPECT_EQ(read_result("a"), read_result("whole"));
}

TEST_F(RunTest, SeveralObjectivesLeaveAFront) {
  RunPlan plan;
  plan.problem = load_problem(
      "q2-pareto", std::vector<std::string>{"workspace.points=4", "sets.validation_cases=2",
                                            "sets.test_cases=2"});
  plan.optimizer = load_optimizer("ga");
  plan.options =
      Options::parse("ga", plan.optimizer.options, std::vector<std::string>{"population=8"});
  plan.schedule = {.fresh = false, .cases = 1};
  plan.budget = 40;
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner);
  // No judged design is better than another one in training in both, but for the best sums.
  std::vector<std::vector<double>> front;
  for (const EvaluationRecord& one : read("a").training) {
    const bool covered = std::ranges::any_of(read("a").training, [&](const auto& other) {
      return other.evaluation.objectives[0] < one.evaluation.objectives[0] &&
             other.evaluation.objectives[1] < one.evaluation.objectives[1];
    });
    if (!covered) {
      front.push_back(one.x);
    }
  }
  for (const std::vector<double>& x : front) {
    EXPECT_TRUE(std::ranges::any_of(
        result->judged, [&](const JudgedCandidate& judged) { return judged.candidate.x == x; }));
  }
  const std::string csv = read_file(temporary_ / "a" / "front.csv", 1 << 20);
  EXPECT_THAT(csv, testing::StartsWith(
                       "evaluation,on_front,failed_cases,error [m],total torque [N m],joint_1.p,"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), std::ssize(result->judged) + 1);
  EXPECT_EQ(get_target(*result).name, "weighted sum");
}

TEST_F(RunTest, AnOptimizerThatDoesNotSuitIsRefusedBeforehand) {
  RunPlan plan = make_failing_plan(1);
  plan.optimizer.requirements.objectives = 2;
  EXPECT_EQ(error_of([&] { run(plan, "a"); }),
            "optimizer 'failing' cannot work on sphere: it needs a problem of at least 2 "
            "objectives, and this one has 1");
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "a"));
}

TEST_F(RunTest, ReasonsOfFailureReachTheResult) {
  RunPlan plan = make_small_plan("ga", 16);
  plan.problem = load_problem(
      "q1-complex", std::vector<std::string>{"workspace.points=4", "workspace.centre_m=[5,0,1]"});
  const auto result = run(plan, "a");
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->winner);
  EXPECT_EQ(result->counts.failed, 16u);
  EXPECT_THAT(result->first_failure, HasSubstr("out of reach"));
}

TEST_F(RunTest, AJournalWithMoreThanIsAskedForIsRefused) {
  run(make_small_plan("ga", 40), "long");
  run(make_small_plan("ga", 24), "short");
  std::filesystem::remove(temporary_ / "short" / "result.json");
  std::filesystem::copy_file(temporary_ / "long" / "journal", temporary_ / "short" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(
      error_of([&] { run(make_small_plan("ga", 24), "short"); }),
      HasSubstr("evaluation 24 of the journal is not what optimizer 'ga' asks for now: it is "
                "recorded, and no longer asked for"));
}

TEST_F(RunTest, AnEndedJournalIsNotContinued) {
  run(make_small_plan("ga", 24), "short");
  run(make_small_plan("ga", 40), "long");
  std::filesystem::remove(temporary_ / "long" / "result.json");
  std::filesystem::copy_file(temporary_ / "short" / "journal", temporary_ / "long" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(error_of([&] { run(make_small_plan("ga", 40), "long"); }),
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
      error_of([&] { run(other, "a"); }),
      AllOf(HasSubstr("holds a run with another configuration"),
            HasSubstr("run.budget: recorded 40, now 48"),
            HasSubstr("problem.task.speed_m_per_s: recorded 1.5, now 2"), HasSubstr("--new")));
}

TEST_F(RunTest, AReplayThatDiffersNamesTheEvaluation) {
  run(make_small_plan(), "a");
  std::filesystem::remove(temporary_ / "a" / "result.json");
  // A journal of another seed under this run's manifest: what another version of an optimizer would
  // look like.
  RunPlan other = make_small_plan();
  other.seed = 7;
  run(other, "b");
  std::filesystem::copy_file(temporary_ / "b" / "journal", temporary_ / "a" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(
      error_of([&] { run(make_small_plan(), "a"); }),
      AllOf(HasSubstr("evaluation 0 of the journal is not what optimizer 'ga' asks for now"),
            HasSubstr("joint_1."), HasSubstr("start a new run with --new")));
}

TEST_F(RunTest, AFreshScheduleNeedsGenerations) {
  RunPlan plan = make_small_plan("random");
  plan.schedule.fresh = true;
  EXPECT_THAT(error_of([&] { run(plan, "a"); }),
              AllOf(HasSubstr("'random' has no generations"), HasSubstr("--schedule fixed:K")));
}

TEST_F(RunTest, AnOptimizerWithoutGenerationsGetsFixedCases) {
  const LoadedProblem problem = load_problem("q1-complex");
  EXPECT_TRUE(choose_schedule(problem, find_optimizer("ga")).fresh);
  EXPECT_FALSE(choose_schedule(problem, find_optimizer("random")).fresh);
  EXPECT_EQ(choose_schedule(problem, find_optimizer("random")).cases, 5);
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
  std::ofstream(temporary_ / "a" / "result.json") << "{}";
  EXPECT_THAT(error_of([&] { run(make_small_plan(), "a"); }),
              HasSubstr("result.json: is not a result that armwright wrote"));
  std::ofstream(temporary_ / "a" / "manifest.json") << "{";
  EXPECT_THAT(error_of([&] { run(make_small_plan(), "a"); }),
              HasSubstr("manifest.json: is not a manifest that armwright wrote"));
}

TEST_F(RunTest, AResultReadsBackTheSame) {
  const auto result = run(make_small_plan(), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(to_json(parse_result(read_result("a"), "result.json")), to_json(*result));
}

TEST_F(RunTest, FoldersAreNumberedAndNeverReused) {
  EXPECT_EQ(choose_run_folder(temporary_ / "", "name", true), temporary_ / "name");
  std::filesystem::create_directories(temporary_ / "name");
  EXPECT_EQ(choose_run_folder(temporary_ / "", "name", false), temporary_ / "name");
  EXPECT_EQ(choose_run_folder(temporary_ / "", "name", true), temporary_ / "name-002");
  std::filesystem::create_directories(temporary_ / "name-002");
  EXPECT_EQ(choose_run_folder(temporary_ / "", "name", true), temporary_ / "name-003");
}

Evaluation make_judgement(double objective, int failed_cases = 0, double violation = 0) {
  Evaluation evaluation;
  evaluation.objectives = {objective};
  evaluation.constraint_values = {violation};
  evaluation.failed_cases = failed_cases;
  return evaluation;
}

TEST(ChooseWinner, FewerFailedCasesThenFeasibilityThenTheObjective) {
  std::vector<JudgedCandidate> judged(4);
  judged[0].validation = make_judgement(1.0, 2);
  judged[1].validation = make_judgement(5.0);
  judged[2].validation = make_judgement(4.0, 0, 0.1);
  judged[3].validation = make_judgement(4.5);
  EXPECT_EQ(Judge::choose_winner(ProblemDescription{}, judged), std::optional<std::size_t>(3));
  judged.resize(1);
  EXPECT_EQ(Judge::choose_winner(ProblemDescription{}, judged), std::optional<std::size_t>(0));
  judged[0].validation = Evaluation{};  // no case yielded a number
  EXPECT_EQ(Judge::choose_winner(ProblemDescription{}, judged), std::nullopt);
}

}  // namespace
}  // namespace armwright
