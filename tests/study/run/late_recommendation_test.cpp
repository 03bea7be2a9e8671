// Tests recommendations after the end of the budget, and runs whose optimizer ends early.
#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/remove_checksums.hpp"
#include "study/run/run.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Written : public Optimizer {
 public:
  explicit Written(const std::function<void(Evaluator&)>& body) : body_(body) {}
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override { body_(evaluator); }

 private:
  const std::function<void(Evaluator&)>& body_;
};

// Stops the run when its candidates are about to be judged.
class StopsBeforeJudging final : public SilentObserver {
 public:
  explicit StopsBeforeJudging(StopSignal& stop) : stop_(stop) {}
  void on_progress(const Progress& progress) override {
    if (progress.phase == CaseRole::validation) {
      stop_.request(StopReason::interrupted);
    }
  }

 private:
  StopSignal& stop_;
};

// Runs on the sphere in two dimensions, whose minimum is at the origin.
class LateRecommendation : public RunTest {
 protected:
  RunPlan make_plan() {
    RunPlan plan;
    plan.problem = load_problem("sphere", std::vector<std::string>{"function.dimension=2"});
    plan.optimizer.name = "written";
    plan.optimizer.make = [this](const Options&) { return std::make_unique<Written>(body_); };
    plan.budget = 5;
    plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 1};
    return plan;
  }
  // Spends the whole budget on the start.
  static void spend(Evaluator& evaluator) {
    std::vector<double> start;
    for (const DecisionVariable& variable : evaluator.problem().variables) {
      start.push_back(variable.start);
    }
    while (!evaluator.stopped()) {
      evaluator.evaluate(std::vector<std::vector<double>>{start});
    }
  }
  static std::size_t count_recommended(const RunResult& result) {
    return static_cast<std::size_t>(std::ranges::count_if(
        result.judged, [](const JudgedCandidate& one) { return one.candidate.recommended; }));
  }

  std::function<void(Evaluator&)> body_;
};

TEST_F(LateRecommendation, IsJudgedAndCanWin) {
  body_ = [](Evaluator& evaluator) {
    spend(evaluator);
    evaluator.recommend(std::vector<double>{0.25, 99});  // outside the bounds
    evaluator.recommend(std::vector<double>{0, 0});
  };
  const auto result = run(make_plan(), "a");
  ASSERT_TRUE(result && result->winner);
  EXPECT_EQ(result->counts.evaluations, 5u);
  EXPECT_EQ(result->end_reason, "budget");
  EXPECT_EQ(count_recommended(*result), 2u);
  EXPECT_EQ(result->judged[*result->winner].candidate.x, (std::vector<double>{0, 0}));
  for (const JudgedCandidate& one : result->judged) {
    EXPECT_LE(one.candidate.x[1], 5) << "it is outside the bounds";
  }
}

TEST_F(LateRecommendation, IsTakenFromTheJournalByAResumedRun) {
  body_ = [](Evaluator& evaluator) {
    spend(evaluator);
    evaluator.recommend(std::vector<double>{0.5, 0.5});
    evaluator.recommend(std::vector<double>{0, 0});
  };
  run(make_plan(), "whole");
  StopSignal stop;
  StopsBeforeJudging observer(stop);
  ASSERT_FALSE(execute_run({make_plan(), temporary_ / "pieces", 1, {}}, stop, observer));
  ASSERT_TRUE(read("pieces").late.has_value());
  EXPECT_EQ(read("pieces").late->count, 2u);
  body_ = spend;  // the machine is slow now, and no recommendation comes in time
  run(make_plan(), "pieces");
  EXPECT_EQ(read_result("pieces"), read_result("whole"));
  // The same holds when the result is made again after the end.
  std::filesystem::remove(temporary_ / "whole" / "result.json");
  run(make_plan(), "whole");
  EXPECT_EQ(read_result("whole"), read_result("pieces"));
}

TEST_F(LateRecommendation, CountsUpToAHundredTimes) {
  body_ = [](Evaluator& evaluator) {
    spend(evaluator);
    for (int i = 0; i < 150; ++i) {
      evaluator.recommend(std::vector<double>{0.01 * i, 0});
    }
  };
  RunPlan plan = make_plan();
  plan.selection = {.last = 1, .best = 0, .most = 1};
  const auto result = run(plan, "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(read("a").late->count, 100u);
  ASSERT_EQ(result->judged.size(), 1u);
  EXPECT_DOUBLE_EQ(result->judged[0].candidate.x[0], 0.99);
}

TEST_F(LateRecommendation, WaitsForTheNextStartIfTheUserStops) {
  body_ = [](Evaluator& evaluator) {
    spend(evaluator);
    evaluator.recommend(std::vector<double>{0, 0});
  };
  StopSignal stop;
  StoppingObserver observer(stop, 2);
  ASSERT_FALSE(execute_run({make_plan(), temporary_ / "a", 1, {}}, stop, observer));
  EXPECT_FALSE(read("a").late.has_value());
  const auto result = run(make_plan(), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(count_recommended(*result), 1u);
}

TEST_F(LateRecommendation, AnOptimizerThatEndsEarlySaysWhyAndHowMuchIsLeft) {
  body_ = [](Evaluator& evaluator) {
    evaluator.evaluate(std::vector<std::vector<double>>{{1, 1}, {2, 1}});
    evaluator.explain_end("its steps are too small");
  };
  const auto result = run(make_plan(), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->end_reason, "optimizer finished");
  EXPECT_EQ(result->end_detail, "its steps are too small");
  EXPECT_EQ(result->unused_evaluations, 3);
  const RunResult recorded = load_result(temporary_ / "a");
  EXPECT_EQ(recorded.end_detail, result->end_detail);
  EXPECT_EQ(recorded.unused_evaluations, 3);
}

TEST_F(LateRecommendation, ARunThatUsesItsBudgetHasNothingToExplain) {
  body_ = [](Evaluator& evaluator) {
    spend(evaluator);
    evaluator.explain_end("nobody asked");
  };
  ASSERT_TRUE(run(make_plan(), "a"));
  EXPECT_THAT(read_result("a"),
              AllOf(Not(HasSubstr("end_detail")), Not(HasSubstr("unused_evaluations"))));
}

TEST_F(LateRecommendation, AnOptimizerThatReturnsAtOnceHasFailed) {
  body_ = [](Evaluator& evaluator) { evaluator.explain_end("no licence"); };
  const auto result = run(make_plan(), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->failure,
            "optimizer 'written' returned without evaluating a point, although the budget pays for "
            "5; its reason: no licence");
  EXPECT_EQ(result->end_reason, "optimizer failed");
  EXPECT_THAT(observer_.messages, testing::Contains("error: " + result->failure));
  // The same command tries again.
  body_ = spend;
  EXPECT_THAT(run(make_plan(), "a")->failure, IsEmpty());
}

TEST_F(LateRecommendation, ABudgetBelowOneEvaluationIsNoFailure) {
  body_ = spend;
  RunPlan plan = make_plan();
  plan.budget = 0;
  body_ = [](Evaluator&) {};
  EXPECT_THAT(run(plan, "a")->failure, IsEmpty());
}

}  // namespace
}  // namespace armwright
