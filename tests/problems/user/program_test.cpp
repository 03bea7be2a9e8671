// Problems that are programs: what they answer, and every way in which they can fail.
#include <gmock/gmock.h>
#include <signal.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/expect_error.hpp"
#include "base/temporary_folder.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/user/user_problem.hpp"
#include "process/stop_scope.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string get_command(const std::string& fault = "") {
  return "exec:python3 " + std::string(ARMWRIGHT_TEST_DATA) + "/../plugins/problem.py " + fault;
}

LoadedProblem load(const std::string& fault, const std::vector<std::string>& settings = {}) {
  return load_problem(get_command(fault), settings);
}

const CaseBlock kFirstCase{CaseRole::training, "train/1", {0}};
const std::vector<double> kGood = {3, 2, 1};  // f = 14
const std::vector<double> kBad = {4.5, 2, 0};

Evaluation evaluate(const LoadedProblem& loaded, const std::vector<double>& x,
                    const CaseBlock& block = kFirstCase) {
  return loaded.problem->evaluate(x, block);
}

// Evaluates a point that fails between two that do not, in one question and alone.
std::string failure_of(const std::string& fault, EvaluationStatus status,
                       const std::vector<std::string>& settings = {}) {
  const LoadedProblem loaded = load(fault, settings);
  EXPECT_EQ(evaluate(loaded, kGood).objectives, std::vector<double>{14});
  const std::vector<CaseJob> jobs = {{.x = kGood, .block = &kFirstCase},
                                     {.x = kBad, .block = &kFirstCase},
                                     {.x = kGood, .block = &kFirstCase}};
  const auto outcomes = loaded.problem->simulate(jobs);
  EXPECT_EQ(outcomes.at(0).error, 14);
  EXPECT_EQ(outcomes.at(2).error, 14);
  EXPECT_FALSE(outcomes.at(1).has_error);
  EXPECT_EQ(outcomes.at(1).status, status) << outcomes.at(1).reason;
  const Evaluation alone = evaluate(loaded, kBad);
  EXPECT_EQ(alone.reason, outcomes.at(1).reason);
  EXPECT_THAT(alone.objectives, IsEmpty());
  EXPECT_EQ(alone.failed_cases, 1);
  EXPECT_EQ(evaluate(loaded, kGood).objectives, std::vector<double>{14});
  return alone.reason;
}

// Returns the error that ends the run.
std::string fault_of(const std::string& fault) {
  const LoadedProblem loaded = load(fault);
  EXPECT_EQ(evaluate(loaded, kGood).objectives, std::vector<double>{14});
  return error_of(ErrorKind::bad_data, [&] { evaluate(loaded, kBad); });
}

std::string refusal_of(const std::string& fault) {
  return error_of(ErrorKind::bad_data, [&] { load(fault); });
}

TEST(ProgramProblem, DescribesItself) {
  const LoadedProblem loaded = load("");
  EXPECT_EQ(loaded.name, "faulty");
  EXPECT_EQ(loaded.title, "x squared and n squared");
  const ProblemDescription& problem = loaded.problem->description();
  ASSERT_EQ(problem.variables.size(), 3U);
  EXPECT_EQ(problem.variables[0].unit, "mm");
  EXPECT_EQ(problem.variables[1].type, VariableType::integer);
  EXPECT_THAT(problem.variables[2].choices, ElementsAre("plain", "dear"));
  EXPECT_EQ(problem.variables[2].upper, 1);
  EXPECT_TRUE(problem.has_single_case);
  EXPECT_EQ(loaded.sets.validation_cases, 1);
  EXPECT_EQ(loaded.input_hashes.size(), 1U);
  EXPECT_EQ(evaluate(loaded, kGood).objectives, std::vector<double>{14});
}

TEST(ProgramProblem, IsReadFromItsRecordWithoutTheProgram) {
  const LoadedProblem loaded = load("");
  nlohmann::json resolved = nlohmann::json::parse(loaded.resolved_json);
  resolved["program"]["command"] = "exec:/no/such/program";
  const LoadedProblem read = load_recorded_problem(resolved.dump(), "faulty", "/");
  EXPECT_EQ(read.problem->description().variables[2].choices[1], "dear");
  EXPECT_EQ(read.sets.test_cases, 1);
  EXPECT_THAT(usage_error_of([&] { evaluate(read, kGood); }), HasSubstr("starts no program"));
}

TEST(ProgramProblem, ObjectivesHaveDirectionsWeightsAndLimits) {
  const LoadedProblem loaded = load("rich");
  const ProblemDescription& problem = loaded.problem->description();
  EXPECT_EQ(problem.objectives[0].name, "-gain");
  EXPECT_THAT(problem.objective_weights, ElementsAre(2, 1));
  EXPECT_EQ(problem.metrics[1].name, "gain");
  EXPECT_FALSE(problem.has_single_case);
  EXPECT_EQ(loaded.sets.test_cases, 2);
  CaseBlock block = kFirstCase;
  block.numbers = {0, 1, 2};
  const Evaluation evaluation = evaluate(loaded, {3, 2, 0}, block);
  EXPECT_THAT(evaluation.objectives, ElementsAre(DoubleEq(8), DoubleEq(3)));
  EXPECT_THAT(evaluation.constraint_values, ElementsAre(DoubleEq(5.0 / 5 - 1)));
  EXPECT_THAT(evaluation.metrics, ElementsAre(DoubleEq(10), DoubleEq(-8)));
  EXPECT_THAT(evaluation.case_errors, ElementsAre(20, 19, 18));
  // Half of the bound on gain: -90 for the two cases that are left.
  EXPECT_EQ(loaded.problem->calc_lower_bound({}, {}, 2), std::nullopt) << "cost has no bound";
}

TEST(ProgramProblem, AFailedTrainingCaseCountsAsThePenaltyAndAJudgedOneIsCounted) {
  const LoadedProblem loaded = load("rich");
  CaseBlock block = kFirstCase;
  block.numbers = {0, 1};
  const Evaluation training = evaluate(loaded, kBad, block);
  EXPECT_EQ(training.status, EvaluationStatus::failed);
  EXPECT_EQ(training.reason, "case 1 is too hard");
  EXPECT_THAT(training.objectives, ElementsAre((20.25 + 100) / 2, (2.0 + 100) / 2));
  EXPECT_EQ(training.failed_cases, 0);
  block.role = CaseRole::test;
  const Evaluation test = evaluate(loaded, kBad, block);
  EXPECT_THAT(test.objectives, ElementsAre(20.25, 2));
  EXPECT_EQ(test.failed_cases, 1);
  EXPECT_EQ(load("").problem->penalty_objectives(), std::vector<double>{1e12});
  EXPECT_THAT(loaded.problem->penalty_objectives(), ElementsAre(100, 100));
}

TEST(ProgramProblem, EveryCaseHasItsOwnSeedWhichDependsOnItsSetAndNumber) {
  const LoadedProblem loaded = load("seeds");
  const auto get_seed = [&](const CaseBlock& block) {
    return evaluate(loaded, kGood, block).objectives.at(0);
  };
  CaseBlock other = kFirstCase;
  other.numbers = {1};
  CaseBlock elsewhere = kFirstCase;
  elsewhere.set = "train/2";
  const double seed = get_seed(kFirstCase);
  EXPECT_GT(seed, 1e9);
  EXPECT_EQ(get_seed(kFirstCase), seed);
  EXPECT_NE(get_seed(other), seed);
  EXPECT_NE(get_seed(elsewhere), seed);
  // In one question each case has the seed that it has alone.
  CaseBlock both = kFirstCase;
  both.numbers = {0, 1};
  EXPECT_THAT(evaluate(loaded, kGood, both).case_errors, ElementsAre(seed, get_seed(other)));
}

TEST(ProgramProblem, HandsOverSignalsAndFiles) {
  const LoadedProblem loaded = load("rich");
  const CaseRecord record = loaded.problem->record_case(kGood, kFirstCase, 0);
  EXPECT_EQ(record.abscissa.unit, "s");
  EXPECT_THAT(record.abscissa_values, ElementsAre(0, 1, 2));
  ASSERT_EQ(record.series.size(), 1U);
  EXPECT_EQ(record.series[0].quantity.name, "speed");
  EXPECT_THAT(record.series[0].values, ElementsAre(0, 0.5, 3));
  ASSERT_EQ(record.files.size(), 2U);
  EXPECT_EQ(record.files[0].bytes, "done");
  EXPECT_EQ(record.files[1].bytes, std::string("\x89PNG\r", 5));
}

TEST(ProgramProblem, ACaseThatFailsIsAnEvaluationWithAReasonAndTheRunGoesOn) {
  using enum EvaluationStatus;
  EXPECT_EQ(failure_of("exit", failed), "the program ended with exit code 3");
  EXPECT_THAT(failure_of("crash", failed), HasSubstr("signal 11 (Segmentation fault)"));
  EXPECT_EQ(failure_of("nan", failed), "its objective 'f' is not a finite number");
  EXPECT_EQ(failure_of("infinite", failed), "its objective 'f' is not a finite number");
  EXPECT_EQ(failure_of("null", failed), "its objective 'f' is not a finite number");
  EXPECT_EQ(failure_of("refuses", diverged), "the beam broke");
  EXPECT_THAT(failure_of("long-line", failed), HasSubstr("a line of more than 64 MiB"));
}

TEST(ProgramProblem, ACaseThatTakesTooLongOrTooMuchMemoryIsAnEvaluationToo) {
  using enum EvaluationStatus;
  const std::vector<std::string> quick = {"program.time_limit_s=2"};
  EXPECT_EQ(failure_of("late", timed_out, quick),
            "the program has been silent for 2 s (program.time_limit_s)");
  EXPECT_THAT(failure_of("closed", failed, quick), HasSubstr("closed its standard output"));
  const LoadedProblem greedy = load("memory", {"program.memory_mib=100"});
  EXPECT_THAT(evaluate(greedy, kBad).reason,
              HasSubstr("took more than 100 MiB of memory (program.memory_mib)"));
  EXPECT_EQ(evaluate(greedy, kGood).objectives, std::vector<double>{14});
  EXPECT_EQ(evaluate(load("deaf", {"program.time_limit_s=1"}), kGood).status, timed_out);
}

TEST(ProgramProblem, TheMemoryLimitCountsWhatTheProgramHasStarted) {
  const LoadedProblem greedy = load("child-memory", {"program.memory_mib=100"});
  EXPECT_EQ(evaluate(greedy, kBad).reason,
            "the program took more than 100 MiB of memory (program.memory_mib)");
  EXPECT_EQ(evaluate(greedy, kGood).objectives, std::vector<double>{14});
}

TEST(ProgramProblem, AWarningHasTheLastWordsOfACrashAndTheRecordedReasonHasNot) {
  const LoadedProblem loaded = load("last-words");
  ProblemWarnings& warnings = *find_warnings(*loaded.problem);
  const std::string reason = "the program ended with exit code 3";
  EXPECT_EQ(evaluate(loaded, kBad).reason, reason);
  EXPECT_EQ(evaluate(loaded, kBad).reason, reason);
  const auto told = warnings.take();
  ASSERT_EQ(told.size(), 1U) << "each reason is told once";
  EXPECT_THAT(told.front(), AllOf(testing::StartsWith(reason + "; the last that it printed:"),
                                  HasSubstr("no mesh")));
  EXPECT_THAT(warnings.take(), IsEmpty());
}

TEST(ProgramProblem, TooFewAnswersToAQuestionAreToldAndAskedForAgain) {
  const LoadedProblem loaded = load("too-few-together", {"program.time_limit_s=1"});
  const std::vector<CaseJob> jobs = {{.x = kGood, .block = &kFirstCase},
                                     {.x = kBad, .block = &kFirstCase}};
  const auto outcomes = loaded.problem->simulate(jobs);
  EXPECT_EQ(outcomes.at(0).error, 14);
  EXPECT_EQ(outcomes.at(1).error, 4.5 * 4.5 + 4);
  EXPECT_THAT(find_warnings(*loaded.problem)->take(),
              ElementsAre("the program did not answer all cases of a question; it sent 1 of 2 "
                          "answers and then has been silent for 1 s (program.time_limit_s); each "
                          "case is asked for again, alone"));
}

TEST(ProgramProblem, TooFewAnswersAreToldOnceHoweverManyThereWere) {
  const LoadedProblem loaded = load("too-few-together", {"program.time_limit_s=0.3"});
  std::vector<CaseJob> jobs = {{.x = kGood, .block = &kFirstCase},
                               {.x = kBad, .block = &kFirstCase}};
  for (int turn = 0; turn < 2; ++turn) {
    loaded.problem->simulate(jobs);
    jobs.insert(jobs.begin(), jobs.front());
  }
  EXPECT_THAT(find_warnings(*loaded.problem)->take(), testing::SizeIs(1));
}

// The stop arrives after the second server has died, the last moment before the case is recorded.
TEST(ProgramProblem, ADeathWithTheStopOfTheRunIsNoFailedCase) {
  const TemporaryFolder folder;
  const auto file = folder / "pids";
  const LoadedProblem loaded = load("dies " + file.string());
  StopSignal stop;
  stop.set_lookout([&] {
    std::ifstream pids(file);
    pid_t first = 0;
    pid_t second = 0;
    if (pids >> first >> second && kill(second, 0) != 0) {
      stop.request(StopReason::terminated);
    }
  });
  const StopScope scope(&stop);
  EXPECT_THROW(evaluate(loaded, kBad), WorkStopped);
}

TEST(ProgramProblem, WhatItStartedIsKilledWithIt) {
  const TemporaryFolder folder;
  const auto file = folder / "pid";
  const LoadedProblem loaded = load("children " + file.string());
  EXPECT_EQ(evaluate(loaded, kBad).reason, "the program ended with exit code 5");
  pid_t child = -1;
  std::ifstream(file) >> child;
  ASSERT_GT(child, 0);
  EXPECT_TRUE(wait_until([&] {
    std::string status;
    std::getline(std::ifstream("/proc/" + std::to_string(child) + "/stat"), status);
    return status.empty() || status.find(") Z") != std::string::npos;
  }));
}

TEST(ProgramProblem, AnAnswerThatBreaksTheProtocolEndsTheRunAndIsShown) {
  EXPECT_THAT(fault_of("not-json"),
              AllOf(HasSubstr("problem 'exec:python3"), HasSubstr("not JSON: 'step 1: ?[31mfine"),
                    HasSubstr("notes belong on standard error")));
  EXPECT_THAT(fault_of("text"), HasSubstr("answer 1 that is no object and no number: '\"large\"'"));
  EXPECT_THAT(fault_of("wrong-length"),
              HasSubstr("whose \"objectives\" are '[1,2]'; the description has 1 of them"));
  EXPECT_THAT(fault_of("missing"), HasSubstr("whose \"objectives\" are missing"));
  EXPECT_THAT(fault_of("status"), HasSubstr("the status 'tired'; possible are"));
  EXPECT_THAT(fault_of("too-many"), HasSubstr("sent 1 answers too many"));
  EXPECT_THAT(fault_of("too-few"), HasSubstr("sent no answers: \"answers\" is '[]'"));
  EXPECT_THAT(fault_of("other-question"), HasSubstr("it was asked question"));
  const LoadedProblem sum = load("sum");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { evaluate(sum, kGood); }),
              HasSubstr("the objective 10 and with residuals whose squares add up to 9"));
}

TEST(ProgramProblem, ABadDescriptionIsRefusedWithTheFieldAndTheValue) {
  EXPECT_THAT(refusal_of("protocol"), HasSubstr("\"protocol\" is '7'; it must be 1"));
  EXPECT_THAT(refusal_of("unknown-type"),
              AllOf(HasSubstr("variables[1] whose \"type\" is '\"complex\"'"),
                    HasSubstr("\"real\" or \"integer\" or \"category\"")));
  EXPECT_THAT(refusal_of("crossed"),
              HasSubstr("variables[0].lower is 6; it must be less than upper, which is 5"));
  EXPECT_THAT(refusal_of("start-outside"),
              HasSubstr("variables[0].start is 5.5; it must lie within the bounds -5 to 5"));
  EXPECT_THAT(refusal_of("half-integer"),
              HasSubstr("variables[1].start is 2.5; an integer's start must be a whole number"));
  EXPECT_THAT(refusal_of("zero-logarithmic"),
              HasSubstr("variables[0].scale is \"logarithmic\", and the bounds -5 and 5"));
  EXPECT_THAT(refusal_of("duplicate"),
              HasSubstr("variables[1].name is 'x', which another one has"));
  EXPECT_THAT(refusal_of("one-word"), HasSubstr("variables[2].choices has one word"));
  EXPECT_THAT(refusal_of("unnamed"), HasSubstr("sent objectives[0] without \"name\""));
  EXPECT_THAT(refusal_of("no-objectives"), HasSubstr("objectives is empty"));
  EXPECT_THAT(refusal_of("no-variables"), HasSubstr("variables is empty"));
  EXPECT_THAT(refusal_of("no-list"),
              HasSubstr("whose \"variables\" is '{\"x\":1}'; it must be a list"));
  EXPECT_THAT(refusal_of("huge-count"), HasSubstr("a whole number from 0 to 1000000"));
  EXPECT_THAT(refusal_of("greeting"), HasSubstr("not JSON: 'Loading the model...'"));
  EXPECT_THAT(refusal_of("other-message"), HasSubstr("not with a message of the type \"problem\""));
  EXPECT_THAT(refusal_of("early-exit"),
              AllOf(HasSubstr("ended with exit code 4 before it described itself"),
                    HasSubstr("no licence")));
  EXPECT_THAT(usage_error_of([] { load_problem("exec:no-such-program-here a"); }),
              HasSubstr("'no-such-program-here'"));
  EXPECT_THAT(usage_error_of([] { load_problem("exec:python3 'a"); }),
              HasSubstr("problem 'exec:python3 'a': a quote (') is not closed"));
}

TEST(ProgramProblem, ADescriptionThatChangesIsRefusedWithTheDifference) {
  const TemporaryFolder folder;
  const LoadedProblem loaded = load("changes " + (folder / "mark").string());
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { evaluate(loaded, kGood); }),
              AllOf(HasSubstr("describes itself differently from what is recorded"),
                    HasSubstr("variables.0.upper: recorded 5.0, now 7.0")));
}

TEST(ProgramProblem, ThreadsHaveAServerEachAndAllGetTheSameAnswers) {
  const LoadedProblem loaded = load("exit");
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> errors(4);
  for (auto& mine : errors) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        const std::vector<double> x = {i % 5 == 4 ? 4.5 : i / 10.0, 1, 0};
        mine.push_back(evaluate(loaded, x).case_errors.front());
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const auto& mine : errors) {
    ASSERT_EQ(mine.size(), 20U);
    EXPECT_EQ(std::memcmp(mine.data(), errors[0].data(), 20 * sizeof(double)), 0);
  }
}

TEST(ProgramProblem, ServersOutliveTheThreadsThatStartedThem) {
  const LoadedProblem loaded = load("");
  for (int i = 0; i < 20; ++i) {
    std::thread([&] { EXPECT_EQ(evaluate(loaded, kGood).status, EvaluationStatus::ok); }).join();
  }
}

}  // namespace
}  // namespace armwright
