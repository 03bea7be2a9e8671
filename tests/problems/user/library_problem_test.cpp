// Problems in shared libraries (include/armwright/problem.h), good and bad ones from
// tests/libraries.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

#include "base/expect_error.hpp"
#include "base/temporary_folder.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/user/case_messages.hpp"
#include "problems/user/library_server.hpp"
#include "problems/user/user_problem.hpp"

namespace armwright {
namespace {

UserProgram load_library(const std::string& name, const ServerLimits& limits) {
  UserProgram program{.name = name, .description = describe_library(name, limits)};
  program.start = make_library_start(name, limits, program.description);
  return program;
}

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const CaseBlock kLibraryCases{CaseRole::training, "train/1", {0}};

std::string get_library(const std::string& name) {
  return std::string(ARMWRIGHT_TEST_LIBRARIES) + "/lib" + name + ".so";
}

std::shared_ptr<const Problem> make_library(const std::string& name,
                                            const ServerLimits& limits = {}) {
  return make_user_problem(load_library(get_library(name), limits));
}

void expect_error(const std::function<void()>& call, ErrorKind kind, const std::string& text) {
  EXPECT_THAT(error_of(kind, call), HasSubstr(text));
}

// Simulates the fault `number` of the library faulty on one case.
CaseOutcome run_fault(const Problem& problem, double number) {
  const std::vector<double> x = {number};
  const CaseJob job{.x = x, .block = &kLibraryCases, .number = 0};
  return problem.simulate({&job, 1}).at(0);
}

// Lets the library faulty describe itself with a fault, and returns the message.
std::string describe_with(const std::string& fault) {
  setenv("FAULT", fault.c_str(), 1);
  std::string message;
  try {
    make_library("faulty");
  } catch (const Error& error) {
    message = error.what();
  }
  unsetenv("FAULT");
  return message;
}

TEST(LibraryProblem, DescribesItself) {
  const auto problem = make_library("mixed");
  const ProblemDescription& description = problem->description();
  EXPECT_EQ(description.name, "mixed");
  ASSERT_EQ(description.variables.size(), 4u);
  EXPECT_EQ(description.variables[0].start, 2);
  EXPECT_THAT(description.variables[1].start, DoubleNear(1, 1e-12));  // sqrt(0.01 * 100)
  EXPECT_EQ(description.variables[2].type, VariableType::integer);
  EXPECT_EQ(description.variables[2].start, 12);
  EXPECT_THAT(description.variables[3].choices, ElementsAre("steel", "brass", "lead"));
  ASSERT_EQ(description.objectives.size(), 2u);
  EXPECT_EQ(description.objectives[1].name, "-speed");
  EXPECT_EQ(description.constraints.at(0).name, "mass");
  EXPECT_FALSE(description.has_single_case);
}

TEST(LibraryProblem, AnswersPerCaseWithTheSeedOfTheCase) {
  const auto problem = make_library("mixed");
  const std::vector<double> x = {0.5, 1, 10, 1};
  const CaseBlock block{CaseRole::validation, "validation/1", {0, 2}};
  std::vector<CaseJob> jobs;
  for (const std::uint64_t number : block.numbers) {
    jobs.push_back({.x = x, .block = &block, .number = number});
  }
  const auto outcomes = problem->simulate(jobs);
  ASSERT_EQ(outcomes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto number = static_cast<double>(block.numbers[i]);
    const auto part = static_cast<double>(calc_case_seed(block, block.numbers[i]) % 7) + number;
    // Cost, speed to be minimised, mass / limit - 1, price, speed as it is.
    EXPECT_THAT(outcomes[i].metrics, ElementsAre(2.25 + part, -10, 20.0 / 40 - 1, 20, 10));
  }
}

TEST(LibraryProblem, AnExceptionFailsItsOwnCaseOfABatch) {
  const auto problem = make_library("mixed");
  const std::vector<double> good = {0.5, 1, 10, 1};
  const std::vector<double> bad = {-1.5, 1, 10, 1};
  const CaseJob first{.x = good, .block = &kLibraryCases, .number = 0};
  const std::vector<CaseJob> jobs = {
      first, {.x = bad, .block = &kLibraryCases, .number = 0}, first};
  const auto outcomes = problem->simulate(jobs);
  EXPECT_EQ(outcomes[0].status, EvaluationStatus::ok);
  EXPECT_EQ(outcomes[1].status, EvaluationStatus::failed);
  EXPECT_EQ(outcomes[1].reason, "the gain is too small");
  EXPECT_EQ(outcomes[0].metrics, outcomes[2].metrics);
}

TEST(LibraryProblem, GetsAtMost1000QuestionsAtOnce) {
  const auto problem = make_library("mixed");
  CaseBlock block{CaseRole::training, "train/1", {}};
  for (std::uint64_t number = 0; number < 2500; ++number) {
    block.numbers.push_back(number);
  }
  const std::vector<double> x = {0.5, 1, 10, 1};
  const Evaluation evaluation = problem->evaluate(x, block);
  EXPECT_EQ(evaluation.status, EvaluationStatus::ok) << evaluation.reason;
  EXPECT_EQ(evaluation.case_errors.size(), 2500u);
}

TEST(LibraryProblem, RecordsACase) {
  const auto problem = make_library("mixed");
  const CaseRecord record =
      problem->record_case(std::vector<double>{4, 1, 10, 0}, {CaseRole::test, "test/1", {3}}, 3);
  EXPECT_EQ(record.abscissa.unit, "s");
  EXPECT_THAT(record.abscissa_values, ElementsAre(0, 1, 2));
  ASSERT_EQ(record.series.size(), 1u);
  EXPECT_THAT(record.series[0].values, ElementsAre(4, 2, 3));
  ASSERT_EQ(record.files.size(), 1u);
  EXPECT_EQ(record.files[0].bytes, "test/1\n");
}

TEST(LibraryProblem, InCHasResidualsAndReasons) {
  const auto problem = make_library("residuals");
  ASSERT_TRUE(problem->description().has_residuals);
  const Evaluation good = problem->evaluate(std::vector<double>{2, 3}, kLibraryCases);
  EXPECT_THAT(good.residuals, ElementsAre(1, 10));
  EXPECT_THAT(good.objectives, ElementsAre(101));
  const Evaluation bad = problem->evaluate(std::vector<double>{4.5, 3}, kLibraryCases);
  EXPECT_EQ(bad.status, EvaluationStatus::diverged);
  EXPECT_EQ(bad.reason, "a is 4.5");
}

TEST(LibraryProblem, IsLoadedByItsPathAndReadWithoutTheLibrary) {
  const LoadedProblem loaded = load_problem(get_library("mixed"));
  EXPECT_EQ(loaded.program, get_library("mixed"));
  EXPECT_EQ(loaded.name, "mixed");
  EXPECT_EQ(loaded.sets.test_cases, 4);
  ASSERT_EQ(loaded.input_hashes.size(), 1u);
  std::string gone = loaded.resolved_json;
  gone.replace(gone.find("libmixed.so"), 11, "gone.so");
  const LoadedProblem recorded = load_recorded_problem(gone, "mixed", ".");
  EXPECT_EQ(recorded.problem->description().variables.size(), 4u);
  EXPECT_THAT(recorded.input_hashes, IsEmpty());
  expect_error(
      [&] {
        recorded.problem->evaluate(std::vector<double>{0, 1, 10, 0}, kLibraryCases);
      },
      ErrorKind::usage, "starts no program");
}

TEST(LibraryProblem, OneCaseFailsWhenItsProcessFails) {
  const auto problem = make_library("faulty");
  std::vector<std::vector<double>> points;
  for (const double number : {0.0, 1.0, 19.0, 2.0, 20.0}) {
    points.push_back({number});
  }
  std::vector<CaseJob> jobs;
  for (const auto& x : points) {
    jobs.push_back({.x = x, .block = &kLibraryCases, .number = 0});
  }
  for (int turn = 0; turn < 2; ++turn) {  // one by one at first, then in one question
    const auto outcomes = problem->simulate(jobs);
    ASSERT_EQ(outcomes.size(), 5u);
    EXPECT_EQ(outcomes[0].error, 0);
    EXPECT_THAT(outcomes[1].reason, HasSubstr("was killed by signal 11"));
    EXPECT_EQ(outcomes[2].error, 19);
    EXPECT_THAT(outcomes[3].reason, HasSubstr("ended its process with exit code 7"));
    EXPECT_EQ(outcomes[4].error, 20);
  }
}

TEST(LibraryProblem, AnEndlessCaseIsKilledAfterItsTimeLimit) {
  const auto problem = make_library("faulty", {.time_limit_s = 0.2});
  const CaseOutcome outcome = run_fault(*problem, 3);
  EXPECT_EQ(outcome.status, EvaluationStatus::timed_out);
  EXPECT_THAT(outcome.reason, HasSubstr("has been silent for 0.2 s (program.time_limit_s)"));
}

TEST(LibraryProblem, TooFewAnswersToAQuestionAreToldAndAskedForAgain) {
  const auto problem = make_library("faulty", {.time_limit_s = 0.2});
  const std::vector<double> good = {19};
  const std::vector<double> endless = {3};
  const std::vector<CaseJob> jobs = {{.x = good, .block = &kLibraryCases, .number = 0},
                                     {.x = endless, .block = &kLibraryCases, .number = 0}};
  const auto outcomes = problem->simulate(jobs);
  EXPECT_EQ(outcomes.at(0).error, 19);
  EXPECT_EQ(outcomes.at(1).status, EvaluationStatus::timed_out);
  EXPECT_THAT(find_warnings(*problem)->take(),
              ElementsAre(HasSubstr("of 2 answers and then has been silent for 0.2 s")));
}

TEST(LibraryProblem, ExceptionsAndNumbersThatAreNotFiniteAreReasons) {
  const auto problem = make_library("faulty");
  EXPECT_EQ(run_fault(*problem, 4).reason, "it broke");
  EXPECT_EQ(run_fault(*problem, 5).reason, "something that is no std::exception was thrown");
  EXPECT_EQ(run_fault(*problem, 7).reason, "its objective 'f' is not a finite number");
  EXPECT_EQ(run_fault(*problem, 8).reason, "its objective 'f' is not a finite number");
  EXPECT_EQ(run_fault(*problem, 14).reason, "no solution");
  EXPECT_EQ(run_fault(*problem, 18).status, EvaluationStatus::diverged);
}

TEST(LibraryProblem, ACaseThatTakesTooMuchMemoryFails) {
  const auto problem = make_library("faulty", {.memory_mib = 100});
  const CaseOutcome outcome = run_fault(*problem, 9);
  EXPECT_EQ(outcome.status, EvaluationStatus::failed);
  EXPECT_THAT(outcome.reason, HasSubstr("memory"));
  EXPECT_EQ(run_fault(*problem, 0).error, 0);
}

TEST(LibraryProblem, OutputAndForkedChildrenDoNotDisturbTheAnswers) {
  const auto problem = make_library("faulty");
  for (const double number : {10.0, 11.0, 12.0, 11.0, 0.0}) {
    const CaseOutcome outcome = run_fault(*problem, number);
    EXPECT_EQ(outcome.status, EvaluationStatus::ok) << number;
    EXPECT_EQ(outcome.error, number);
  }
}

TEST(LibraryProblem, BreakingTheContractEndsTheRunWithAReason) {
  const auto problem = make_library("faulty");
  const auto expect_end = [&](double number, const std::string& text) {
    expect_error([&] { run_fault(*problem, number); }, ErrorKind::bad_data, text);
  };
  expect_end(6, "it can compute no case: it answered with 2 objectives; its description has 1");
  expect_end(13, "it can compute no case: the file of measurements is missing");
  expect_end(15, "it answered with the status 17");
}

TEST(LibraryProblem, WritingIntoTheConnectionOrClosingItFailsTheCase) {
  const auto problem = make_library("faulty", {.time_limit_s = 5});
  EXPECT_THAT(run_fault(*problem, 16).reason,
              HasSubstr("has written into the connection to its parent"));
  EXPECT_EQ(run_fault(*problem, 17).status, EvaluationStatus::failed);
  EXPECT_EQ(run_fault(*problem, 0).error, 0);
}

TEST(LibraryProblem, ADescriptionThatIsWrongNamesTheField) {
  EXPECT_THAT(describe_with("bounds"),
              HasSubstr("variables[0].lower is 30; it must be less than upper, which is 20"));
  EXPECT_THAT(describe_with("start"), HasSubstr("variables[0].start is 21; it must lie within"));
  EXPECT_THAT(describe_with("twice"), HasSubstr("variables[1].name is 'fault', which another one"));
  EXPECT_THAT(describe_with("infinite"),
              HasSubstr("variables[0].upper is inf; it must be a finite"));
  EXPECT_THAT(describe_with("type"), HasSubstr("variables[0].type is 7"));
  EXPECT_THAT(describe_with("nameless"), HasSubstr("objectives[0]"));
  EXPECT_THAT(describe_with("word"), HasSubstr("variables[0].start is 2; it must be the place of"));
  EXPECT_THAT(describe_with("none"), IsEmpty());
}

TEST(LibraryProblem, AFailureWhileItIsOpenedSaysWhatItPrinted) {
  EXPECT_THAT(describe_with("crash"), HasSubstr("was killed by signal 11"));
  EXPECT_THAT(describe_with("crash"), HasSubstr("about to crash"));
  EXPECT_THAT(describe_with("exit"), HasSubstr("ended its process with exit code 3"));
  EXPECT_THAT(describe_with("exception"), HasSubstr("threw an exception (no licence)"));
}

TEST(LibraryProblem, ADescriptionThatChangesIsRefusedWithTheDifference) {
  const auto problem = make_library("faulty");
  setenv("FAULT", "other", 1);
  expect_error([&] { run_fault(*problem, 0); }, ErrorKind::bad_data,
               "describes itself differently from what is recorded");
  unsetenv("FAULT");
}

TEST(LibraryProblem, FilesThatAreNoProblemsAreRefused) {
  const auto open = [](const std::string& name) { return [name] { load_library(name, {}); }; };
  expect_error(open("./missing.so"), ErrorKind::usage, "there is no such file");
  expect_error(open(std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so"), ErrorKind::bad_data,
               "is an optimizer and no problem; name it with --optimizer");
  const TemporaryFolder folder;
  const auto text = folder.path() / "text.so";
  std::ofstream(text) << "no library";
  expect_error(open(text.string()), ErrorKind::bad_data, "is no shared library that can be opened");
}

TEST(LibraryProblem, AFileWithASlashIsALibraryIfItBeginsAsOne) {
  EXPECT_TRUE(is_problem_library("mine.so"));
  EXPECT_FALSE(is_problem_library("./mine.toml"));
  const TemporaryFolder folder;
  const auto copy = folder.path() / "libmine.so.2";
  std::filesystem::copy_file(get_library("residuals"), copy);
  EXPECT_TRUE(is_problem_library(copy.string()));
  std::ofstream(folder.path() / "other.2") << "kind = \"program\"\n";
  EXPECT_FALSE(is_problem_library((folder.path() / "other.2").string()));
}

TEST(LibraryProblem, AFileThatWasReplacedIsNotOpened) {
  const TemporaryFolder folder;
  const auto copy = folder.path() / "mine.so";
  std::filesystem::copy_file(get_library("faulty"), copy);
  const auto problem = make_user_problem(load_library(copy.string(), {}));
  std::filesystem::remove(copy);
  std::filesystem::copy_file(get_library("residuals"), copy);
  expect_error([&] { run_fault(*problem, 0); }, ErrorKind::bad_data,
               "it is no longer the file that it was when this program started");
}

}  // namespace
}  // namespace armwright
