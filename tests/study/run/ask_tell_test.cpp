// Tests runs whose evaluations somebody else makes.
#include "study/run/ask_tell.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <deque>

#include "base/error.hpp"
#include "base/remove_checksums.hpp"
#include "study/own_problem.hpp"
#include "study/run_support.hpp"
#include "study/survey/store_survey.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class AskTell : public RunTest {
 protected:
  RunRequest make_request(const std::string& optimizer, const std::string& folder) {
    RunRequest request;
    request.plan.problem = make_own_problem(describe_own(), nullptr);
    request.plan.optimizer = load_optimizer(optimizer);
    request.plan.options = Options::parse(
        optimizer, request.plan.optimizer.options,
        optimizer == "ga" ? std::vector<std::string>{"population=6"} : std::vector<std::string>{});
    request.plan.budget = 20;
    request.plan.schedule = request.plan.problem.schedule;
    request.folder = temporary_ / folder;
    request.command_line = {"armwright", "ask"};
    return request;
  }
  AskOutcome ask_for(const RunRequest& request, std::size_t count) {
    return ask(request, count, observer_);
  }
  void tell_one(const RunRequest& request, const AskedPoint& point) {
    tell_one(request, {point.id, answer_own(point.x), "here"});
  }
  void tell_one(const RunRequest& request, const ToldAnswer& told) {
    tell(request.folder, *request.plan.problem.problem, {&told, 1});
  }
  std::string fail_to_tell(const RunRequest& request, const ToldAnswer& told) {
    try {
      tell_one(request, told);
    } catch (const Error& error) {
      return error.what();
    }
    return "told";
  }
  // Asks for `count` points at a time, tells the newest of `kept` points first, to the end.
  RunResult finish(const RunRequest& request, std::size_t count, std::size_t kept) {
    std::deque<AskedPoint> open;
    for (int round = 0; round < 200; ++round) {
      AskOutcome outcome = ask_for(request, count);
      if (outcome.result) {
        return *outcome.result;
      }
      open.insert(open.end(), outcome.points.begin(), outcome.points.end());
      EXPECT_FALSE(open.empty());
      while (open.size() > (outcome.points.empty() ? 0 : kept)) {
        tell_one(request, open.back());
        open.pop_back();
      }
    }
    ADD_FAILURE() << "the run does not end";
    return {};
  }
  // Runs the same plan with simulations.
  std::string simulate(RunRequest request, const std::string& folder) {
    prepare_to_ask(request.plan);
    request.plan.problem = make_own_problem(describe_own(), std::make_shared<OwnProblemCounts>());
    EXPECT_TRUE(run(request.plan, folder));
    return read_result(folder);
  }
};

TEST_F(AskTell, EndsWithTheResultOfARunThatSimulates) {
  for (const char* optimizer : {"ga", "cmaes", "nlopt:cobyla", "random", "lhs"}) {
    const std::string name = optimizer;
    if (!load_optimizer(name).unavailable.empty()) {
      continue;
    }
    const RunRequest request = make_request(name, "told-" + name);
    finish(request, 4, 2);
    EXPECT_EQ(read_result("told-" + name), simulate(request, "run-" + name)) << name;
    EXPECT_FALSE(path_exists(request.folder / kAskedFile)) << name;
  }
}

TEST_F(AskTell, ALargerBudgetContinuesAnEndedRun) {
  RunRequest request = make_request("ga", "run");
  finish(request, 4, 2);
  request.plan.budget = 32;
  EXPECT_EQ(finish(request, 4, 2).counts.evaluations, 32u);
  EXPECT_EQ(read_result("run"), simulate(request, "simulated"));
}

TEST_F(AskTell, HandsOutEachPointOnceAndShowsWhatWaits) {
  const RunRequest request = make_request("ga", "run");
  const AskOutcome first = ask_for(request, 2);
  ASSERT_THAT(first.points, SizeIs(2));
  EXPECT_THAT(first.waiting, IsEmpty());
  const AskOutcome second = ask_for(request, 100);
  ASSERT_THAT(second.points, SizeIs(4));  // of a population of 6
  EXPECT_THAT(second.waiting, SizeIs(2));
  EXPECT_EQ(second.points.front().id, 2u);
  EXPECT_THAT(ask_for(request, 100).points, IsEmpty());
  tell_one(request, second.points.back());
  EXPECT_THAT(ask_for(request, 100).waiting, SizeIs(5));
}

TEST_F(AskTell, AnUnfinishedRunIsContinuedByAskingAgain) {
  const RunRequest request = make_request("ga", "run");
  ask_for(request, 1);
  EXPECT_THAT(make_command(survey_store(request.folder), "armwright", request.folder),
              ElementsAre("armwright", "ask", request.folder.string()));
}

TEST_F(AskTell, AnotherBuildIsNoWarningBecauseNothingIsSimulated) {
  class Messages final : public RunObserver {
   public:
    void on_progress(const Progress& /*progress*/) override {}
    void on_message(const std::string& message) override { text += message + "\n"; }
    std::string text;
  } messages;
  const RunRequest request = make_request("ga", "run");
  ask_for(request, 1);
  remove_checksums(request.folder);
  const auto file = request.folder / "manifest.json";
  std::string manifest = read_file(file, 1 << 20);
  manifest.insert(manifest.find("\"version\": \"") + 12, "9");
  write_file_atomically(file, manifest);
  EXPECT_THAT(ask(request, 100, messages).points, SizeIs(5));
  EXPECT_THAT(messages.text, Not(HasSubstr("warning")));
}

TEST_F(AskTell, ASequentialOptimizerAsksForOnePoint) {
  const RunRequest request = make_request("nlopt:cobyla", "run");
  if (!request.plan.optimizer.unavailable.empty()) {
    GTEST_SKIP() << "this build has no NLopt";
  }
  EXPECT_THAT(ask_for(request, 10).points, SizeIs(1));
}

TEST_F(AskTell, RefusesIdentifiersThatWereNotAskedForOrToldBefore) {
  const RunRequest request = make_request("ga", "run");
  const AskOutcome outcome = ask_for(request, 2);
  EXPECT_THAT(fail_to_tell(request, {7, answer_own(outcome.points[0].x), "results.csv:4"}),
              HasSubstr("results.csv:4: point 7 was never handed out"));
  tell_one(request, outcome.points[0]);
  EXPECT_THAT(fail_to_tell(request, {0, answer_own(outcome.points[0].x), "results.csv:2"}),
              HasSubstr("results.csv:2: point 0 has a result already"));
  const std::vector<ToldAnswer> twice = {{1, answer_own(outcome.points[1].x), "r:1"},
                                         {1, answer_own(outcome.points[1].x), "r:2"}};
  EXPECT_THROW(tell(request.folder, *request.plan.problem.problem, twice), Error);
  EXPECT_EQ(read("run").training.size(), 1u);  // of a refused file, no line is recorded
}

TEST_F(AskTell, AMissingResultIsAFailedEvaluationWithItsReason) {
  const RunRequest request = make_request("ga", "run");
  const AskOutcome outcome = ask_for(request, 1);
  const auto told =
      read_told(R"({"id": 0, "missing": "the fuse blew"})", "r", *request.plan.problem.problem);
  tell_one(request, told.front());
  const EvaluationRecord record = read("run").training.front();
  EXPECT_EQ(record.evaluation.status, EvaluationStatus::failed);
  EXPECT_EQ(record.evaluation.reason, "the fuse blew");
  EXPECT_THAT(record.evaluation.objectives, IsEmpty());
}

TEST_F(AskTell, RefusesPointsThatTheOptimizerDoesNotAskFor) {
  const RunRequest request = make_request("ga", "run");
  ask_for(request, 1);
  std::string text = read_file(request.folder / kAskedFile, 1 << 20);
  text.replace(text.find("\"x\":["), 5, "\"x\":[1e-9,");
  write_file_atomically(request.folder / kAskedFile, text);
  EXPECT_THROW(ask_for(request, 1), Error);  // three numbers of two
  write_file_atomically(request.folder / kAskedFile, "{}");
  EXPECT_THROW(ask_for(request, 1), Error);
  std::filesystem::remove(request.folder / kAskedFile);
  EXPECT_THAT(ask_for(request, 1).points, SizeIs(1));
}

TEST_F(AskTell, RefusesProblemsThatArmwrightSimulatesItself) {
  RunPlan plan = make_small_plan();
  EXPECT_THROW(prepare_to_ask(plan), Error);
  UserDescription description = describe_own();
  description.training_cases = 3;
  plan.problem = make_own_problem(description, nullptr);
  EXPECT_THROW(prepare_to_ask(plan), Error);
}

class ToldFile : public testing::Test {
 protected:
  std::vector<ToldAnswer> read(std::string_view text) {
    return read_told(text, "r", *problem_.problem);
  }
  std::string fail(std::string_view text) {
    try {
      read(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "read";
  }

  LoadedProblem problem_ = make_own_problem(describe_own(), nullptr);
};

TEST_F(ToldFile, ReadsJsonLines) {
  const auto told = read(
      "{\"id\": 4, \"objectives\": [1.5], \"constraints\": [2], \"metrics\": [3]}\n\n"
      "{\"id\": 2, \"missing\": \"no power\"}\n");
  ASSERT_THAT(told, SizeIs(2));
  EXPECT_EQ(told[0].id, 4u);
  EXPECT_THAT(told[0].answer.objectives, ElementsAre(1.5));
  EXPECT_EQ(told[1].answer.reason, "no power");
  EXPECT_EQ(told[1].where, "r:3");
}

TEST_F(ToldFile, ReadsCsvInAnyOrderOfColumns) {
  const auto told =
      read("sum,id,a,loss,product,missing\n2,4,0.5,1.5,3,\n,5,,,,\"late, too late\"\n");
  ASSERT_THAT(told, SizeIs(2));
  EXPECT_THAT(told[0].answer.objectives, ElementsAre(1.5));
  EXPECT_THAT(told[0].answer.constraints, ElementsAre(2));
  EXPECT_EQ(told[1].answer.reason, "late, too late");
}

TEST_F(ToldFile, RefusesWhatItCannotUseWithTheLine) {
  EXPECT_THAT(fail("{\"id\": -1}"), HasSubstr("r:1: its \"id\" is '-1'"));
  EXPECT_THAT(fail("{\"id\": 1, \"objectives\": [1, 2], \"constraints\": [2], \"metrics\": [3]}"),
              HasSubstr("r:1: this line sent a result whose \"objectives\" are"));
  EXPECT_THAT(fail("{\"id\": 1, \"objective\": [1]}"), HasSubstr("did you mean 'objectives'?"));
  EXPECT_THAT(fail("{\"id\": 1"), HasSubstr("not a JSON object"));
  EXPECT_THAT(fail("id,loss,sum\n"), HasSubstr("r:1: has no column 'product'"));
  EXPECT_THAT(fail("id,loss,sum,product,los\n"), HasSubstr("r:1: unknown column 'los'"));
  EXPECT_THAT(fail("id,loss,sum,product\n1,2,3\n"), HasSubstr("r:2: has 3 fields"));
  EXPECT_THAT(fail("id,loss,sum,product\n1,nan,3,4\n"), HasSubstr("r:2: its 'loss' is 'nan'"));
  EXPECT_THAT(fail("id,loss,sum,product\nx,1,3,4\n"), HasSubstr("r:2: its id is 'x'"));
}

}  // namespace
}  // namespace armwright
