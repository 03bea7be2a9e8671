// Tests that a run on a problem with a single case simulates no decision vector twice.
#include <fmt/format.h>

#include <memory>

#include "study/own_problem.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

class Recommends : public Optimizer {
 public:
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    const std::vector<std::vector<double>> points = {{2, 2}, {1.5, 1}, {-3.5, 0}, {1.25, 0}};
    evaluator.recommend(std::vector<double>{1, 0});     // the best, and never evaluated
    evaluator.recommend(std::vector<double>{-3.5, 0});  // fails
    evaluator.recommend(std::vector<double>{1.25, 0});
    evaluator.evaluate(points);
  }
};

class SingleCase : public RunTest {
 protected:
  RunPlan make_plan() {
    RunPlan plan;
    plan.problem = make_own_problem(describe_own(), counts_);
    plan.optimizer.name = "recommends";
    plan.optimizer.make = [](const Options&) { return std::make_unique<Recommends>(); };
    plan.budget = 4;
    plan.schedule = plan.problem.schedule;
    return plan;
  }

  std::shared_ptr<OwnProblemCounts> counts_ = std::make_shared<OwnProblemCounts>();
};

TEST_F(SingleCase, SimulatesOnlyWhatWasNotEvaluated) {
  const auto result = run(make_plan(), "run", 1);
  ASSERT_TRUE(result);
  // Four evaluations, and the recommendation that was not evaluated.
  EXPECT_EQ(counts_->points.size(), 5u);
  EXPECT_EQ(counts_->points.count({1, 0}), 1u);
  ASSERT_TRUE(result->winner);
  EXPECT_EQ(result->judged[*result->winner].candidate.x, (std::vector<double>{1, 0}));
}

TEST_F(SingleCase, TakesTheWinnersTestFromItsEvaluation) {
  RunPlan plan = make_plan();
  plan.selection.evaluated_only = true;
  const auto result = run(plan, "run", 1);
  ASSERT_TRUE(result && result->winner);
  EXPECT_EQ(counts_->points.size(), 4u);
  EXPECT_EQ(result->judged[*result->winner].candidate.x, (std::vector<double>{1.25, 0}));
  EXPECT_EQ(result->test.objectives, (std::vector<double>{0.0625}));
  EXPECT_EQ(result->test_summary.failures, 0);
  for (const JudgedCandidate& judged : result->judged) {
    const bool fails = judged.candidate.x[0] < -3;
    EXPECT_EQ(judged.validation.failed_cases, fails ? 1 : 0);
    EXPECT_EQ(judged.validation.objectives.empty(), fails);
  }
}

TEST_F(SingleCase, HasTheSameResultWithSeveralCasesOfTheSameValue) {
  const auto single = run(make_plan(), "single", 1);
  RunPlan plan = make_plan();
  UserDescription description = describe_own();
  description.is_deterministic = false;  // so that every judgement is simulated
  plan.problem = make_own_problem(description, counts_);
  const auto several = run(plan, "several", 1);
  ASSERT_TRUE(single && several);
  EXPECT_EQ(read_result("single"), read_result("several"));
}

TEST_F(SingleCase, GivesTheSameBytesAfterEveryInterruption) {
  ASSERT_TRUE(run(make_plan(), "whole", 1));
  for (std::uint64_t after = 1; after <= 7; ++after) {
    const std::string folder = fmt::format("cut-{}", after);
    StopSignal stop;
    StoppingObserver observer(stop, after);
    execute_run({make_plan(), temporary_ / folder, 1, {"armwright"}}, stop, observer);
    ASSERT_TRUE(run(make_plan(), folder, 1));
    EXPECT_EQ(read_result(folder), read_result("whole")) << after;
  }
}

}  // namespace
}  // namespace armwright
