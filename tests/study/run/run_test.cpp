// Tests whole runs in one process: exact budgets, schedules, results that do not depend on threads.
// Interrupted and repeated runs: run_resume_test.cpp; failures and fronts: run_failure_test.cpp.
#include "study/run/run.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/expect_error.hpp"
#include "base/text.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/lanes_engine.hpp"
#include "study/run/design_evaluation.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/winner_selection.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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

TEST_F(RunTest, TheStartIsJudgedOnTheCasesOfTheWinnersTest) {
  const RunPlan plan = make_small_plan();
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner && result->start);
  const Problem& problem = *plan.problem.problem;
  const Evaluation start = problem.evaluate(list_starts(problem.description().variables),
                                            {CaseRole::test, plan.problem.sets.test, {0, 1, 2, 3}});
  EXPECT_EQ(result->start->test.case_errors, start.case_errors);
  EXPECT_EQ(result->start->is_worse_than_winner, calc_rank(problem.description(), result->test) <
                                                     calc_rank(problem.description(), start));
}

TEST_F(RunTest, AWinnerThatIsTheStartIsNotBetterThanIt) {
  const auto result = run(make_small_plan("start"), "a");
  ASSERT_TRUE(result && result->winner && result->start);
  EXPECT_FALSE(result->start->is_worse_than_winner);
  EXPECT_THAT(list_faults(*result),
              testing::ElementsAre("no design better than the start was found"));
}

TEST(ListFaults, NameFailuresBesideThoseOfTheStartAndConstraints) {
  RunResult result;
  result.tracking = true;
  result.test.case_errors = {0.001, 0.2, std::numeric_limits<double>::quiet_NaN()};
  result.test_summary = summarize(result.test.case_errors, get_failure_error(result));
  EXPECT_THAT(list_faults(result), testing::IsEmpty());  // there is no winner
  result.judged.resize(1);
  result.winner = 0;
  EXPECT_THAT(list_faults(result), testing::ElementsAre("the winner fails 2 of 3 test cases"));
  result.constraints = {{"total_torque", "N m"}, {"error", "m"}};
  result.test.constraint_values = {0, 0.5};
  EXPECT_THAT(list_faults(result),
              testing::ElementsAre("the winner fails 2 of 3 test cases",
                                   "on the test set the winner violates error"));
  result.test.constraint_values = {0, -0.5};
  result.start.emplace().is_worse_than_winner = true;
  result.start->test.case_errors = {0.008, 0.009, 0.11};
  EXPECT_THAT(list_faults(result),
              testing::ElementsAre("the winner fails 2 of 3 test cases (the start: 1)"));
}

TEST(EvaluateDesign, InBatchesItIsWhatCaseByCaseGives) {
  const LoadedProblem loaded =
      load_problem("q1-complex",
                   std::vector<std::string>{"workspace.points=3", "physics.engine=ode",
                                            "physics.judging_engine=lanes"},
                   engines_with_lanes());
  const TrackingProblem* problem = loaded.tracking();
  const ArmDesign& design = problem->config().start;
  const TestSet set = problem->get_set("test/2");
  for (const unsigned jobs : {1U, 3U}) {
    StopSignal stop;
    const auto results = evaluate_design(*problem, design, set, 5, 70, jobs, false, stop);
    ASSERT_TRUE(results);
    ASSERT_EQ(results->size(), 70u);
    for (std::uint64_t i = 0; i < 70; ++i) {
      EXPECT_EQ((*results)[i].result.mean_error_m, problem->track(design, set, 5 + i).mean_error_m)
          << i;
    }
    stop.request(StopReason::interrupted);
    EXPECT_FALSE(evaluate_design(*problem, design, set, 5, 70, jobs, false, stop));
  }
}

// The distances of all four test cases, measured again one by one.
TEST_F(RunTest, TheWinnersMotionIsThatOfItsTestCases) {
  const RunPlan plan = make_small_plan();
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->test_motion);
  const TrackingProblem& problem = *plan.problem.tracking();
  const ArmDesign design = problem.make_design(result->judged[*result->winner].candidate.x);
  MotionErrors errors;
  for (std::uint64_t number = 0; number < 4; ++number) {
    const TestSet set = problem.get_set("test/2");
    const TrackingResult motion = problem.track(design, set, number, {.error_series = true});
    EXPECT_EQ(motion.mean_error_m, result->test.case_errors[number]);
    errors.add(measure_motion(problem.config().task,
                              problem.setup().make_targets(set.make_case(number)),
                              motion.error_series_m));
  }
  const MotionSummary expected = errors.summarize().value();
  EXPECT_EQ(result->test_motion->moving_rms_m, expected.moving_rms_m);
  EXPECT_EQ(result->test_motion->moving_peak_m, expected.moving_peak_m);
  EXPECT_EQ(result->test_motion->start_up_m, expected.start_up_m);
  EXPECT_GT(expected.moving_peak_m, expected.moving_rms_m);
  EXPECT_EQ(get_effort_totals(*result).torque_n_m, calc_total_effort(design));
  EXPECT_THAT(read_result("a"), testing::Not(HasSubstr("total_force_n")));
}

TEST_F(RunTest, CellsAreNotMeasured) {
  StopSignal stop;
  const auto cell = execute_run(
      {make_small_plan(), temporary_ / "cell", 2, {}, DerivedFiles::winner}, stop, observer_);
  EXPECT_FALSE(cell->test_motion);
  EXPECT_THAT(read_result("cell"), testing::Not(HasSubstr("motion")));
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

TEST_F(RunTest, AFreshScheduleNeedsGenerations) {
  RunPlan plan = make_small_plan("random");
  plan.schedule.kind = Schedule::Kind::fresh;
  EXPECT_THAT(usage_error_of([&] { run(plan, "a"); }),
              AllOf(HasSubstr("'random' has no generations"), HasSubstr("--schedule fixed:K")));
}

TEST_F(RunTest, AnOptimizerWithoutGenerationsGetsFixedCases) {
  const LoadedProblem problem = load_problem("q1-complex");
  EXPECT_TRUE(choose_schedule(problem, find_optimizer("ga")).changes_cases());
  EXPECT_FALSE(choose_schedule(problem, find_optimizer("random")).changes_cases());
  EXPECT_EQ(choose_schedule(problem, find_optimizer("random")).cases, 5);
}

TEST_F(RunTest, AResultReadsBackTheSame) {
  const auto result = run(make_small_plan(), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(to_json(parse_result(read_result("a"), "result.json")), to_json(*result));
}

TEST(RunResult, OfAnArmThatSlidesHasItsForceApart) {
  RunResult result;
  result.objectives = {{"error", "m"}};
  result.metric_names = {"total_torque"};
  result.judged.emplace_back();
  result.winner = 0;
  result.test.metrics = {520};
  EXPECT_EQ(get_effort_totals(result).torque_n_m, 520);
  EXPECT_EQ(get_effort_totals(result).force_n, std::nullopt);
  result.sliding_efforts = {.torque_n_m = 120, .force_n = 400};
  result.test_motion = {.moving_rms_m = 0.1, .moving_peak_m = 0.3, .start_up_m = {}};
  const RunResult read = parse_result(to_json(result), "result.json");
  EXPECT_EQ(get_effort_totals(read).torque_n_m, 120);
  EXPECT_EQ(get_effort_totals(read).force_n, 400);
  EXPECT_EQ(read.test_motion->moving_peak_m, 0.3);
  EXPECT_EQ(read.test_motion->start_up_m, std::nullopt);
  EXPECT_EQ(to_json(read), to_json(result));
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
  evaluation.case_errors.assign(3, objective);
  std::fill_n(evaluation.case_errors.begin(), failed_cases,
              std::numeric_limits<double>::quiet_NaN());
  return evaluation;
}

TEST(ShortenOptimizer, LeavesOutTheFoldersOfAPlugin) {
  EXPECT_EQ(shorten_optimizer("/long/path/libmine.so"), "libmine.so");
  EXPECT_EQ(shorten_optimizer("./libmine.so"), "libmine.so");
  EXPECT_EQ(shorten_optimizer("multistart:/long/path/libmine.so"), "multistart:libmine.so");
  for (const std::string name : {"ga", "nlopt:cobyla", "multistart:nlopt:cobyla", "python:mine"}) {
    EXPECT_EQ(shorten_optimizer(name), name);
  }
}

// Returns the judgement of a design by the errors (m) of its cases; NaN: the case has no number.
JudgedCandidate judge_errors(const std::vector<double>& errors_m) {
  JudgedCandidate judged;
  double sum = 0;
  int numbers = 0;
  for (const double error_m : errors_m) {
    sum += std::isnan(error_m) ? 0 : error_m;
    numbers += std::isnan(error_m) ? 0 : 1;
  }
  judged.validation.case_errors = errors_m;
  judged.validation.failed_cases = static_cast<int>(errors_m.size()) - numbers;
  if (numbers > 0) {
    judged.validation.objectives = {sum / numbers};
  }
  return judged;
}

// Four candidates lose a few cases without a number; forty lie on the floor in all cases, with a
// number each.
TEST(ChooseWinner, AnArmOnTheFloorLosesToOneThatDivergesInAFewCases) {
  ProblemDescription arm;
  arm.failure_error = kFailureError_m;
  std::vector<JudgedCandidate> judged;
  for (int i = 0; i < 40; ++i) {
    judged.push_back(judge_errors(std::vector<double>(100, 3.1)));
  }
  for (const int diverged : {18, 14, 11, 16}) {
    std::vector<double> errors_m(100, 0.0001);
    std::fill_n(errors_m.begin(), diverged, std::numeric_limits<double>::quiet_NaN());
    std::fill_n(errors_m.end() - 20, 20, 0.5);
    judged.push_back(judge_errors(errors_m));
  }
  EXPECT_EQ(choose_winner(arm, judged), std::optional<std::size_t>(42));
  EXPECT_LT(calc_rank(arm, judge_errors(std::vector<double>(100, 0.0083)).validation),
            calc_rank(arm, judged[42].validation));  // the start follows its target in all cases
}

TEST(ChooseWinner, FewerFailedCasesThenFeasibilityThenTheObjective) {
  std::vector<JudgedCandidate> judged(4);
  judged[0].validation = make_judgement(1.0, 2);
  judged[1].validation = make_judgement(5.0);
  judged[2].validation = make_judgement(4.0, 0, 0.1);
  judged[3].validation = make_judgement(4.5);
  EXPECT_EQ(choose_winner(ProblemDescription{}, judged), std::optional<std::size_t>(3));
  judged.resize(1);
  EXPECT_EQ(choose_winner(ProblemDescription{}, judged), std::optional<std::size_t>(0));
  judged[0].validation = Evaluation{};  // no case yielded a number
  EXPECT_EQ(choose_winner(ProblemDescription{}, judged), std::nullopt);
}

}  // namespace
}  // namespace armwright
