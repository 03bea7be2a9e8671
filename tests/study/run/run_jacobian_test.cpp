// Tests runs with exact derivatives, which are charged, journalled and replayed like others.
#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/run/run_observer.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

// Asks in turn for one point with derivatives and three without: (1 + 20/4 + 3) times two cases.
class Alternating : public Optimizer {
 public:
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    std::vector<double> x;
    for (const DecisionVariable& variable : evaluator.problem().variables) {
      x.push_back(variable.start);
    }
    while (!evaluator.stopped()) {
      for (const Score& score : evaluator.evaluate_with_jacobian({&x, 1})) {
        EXPECT_FALSE(score.residuals.empty());
        EXPECT_EQ(score.jacobian.size(), score.residuals.size() * x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
          // A small step along the negative gradient of the sum of squares.
          double slope = 0;
          for (std::size_t k = 0; k < score.residuals.size(); ++k) {
            slope += score.residuals[k] * score.jacobian[k * x.size() + i];
          }
          x[i] -= 0.01 * std::abs(x[i]) * (slope > 0 ? 1 : -1);
        }
      }
      const std::vector<std::vector<double>> points(3, x);
      for (const Score& score : evaluator.evaluate(points)) {
        EXPECT_TRUE(score.jacobian.empty());
      }
    }
  }
};

RunPlan make_plan(const std::string& engine, std::int64_t budget) {
  RunPlan plan = make_small_plan("random", budget);
  plan.problem = load_problem(
      "q1-complex", std::vector<std::string>{"workspace.points=4", "sets.validation_cases=3",
                                             "sets.test_cases=4", "physics.engine=" + engine});
  plan.optimizer.name = "alternating";
  plan.optimizer.options = {};
  plan.optimizer.capabilities.residuals = true;
  plan.optimizer.make = [](const Options&) { return std::make_unique<Alternating>(); };
  plan.options = Options::parse("alternating", {}, {});
  return plan;
}

TEST_F(RunTest, DerivativesAreChargedExactlyAndInWholeCandidates) {
  // Two cases per candidate: 12 with derivatives, 6 for three points without.
  for (const auto& [budget, cases, evaluations] : {std::tuple{11, 0, 0},
                                                   {12, 12, 1},
                                                   {13, 12, 1},
                                                   {14, 14, 2},
                                                   {18, 18, 4},
                                                   {29, 18, 4},
                                                   {30, 30, 5},
                                                   {36, 36, 8}}) {
    const auto result = run(make_plan("articulated", budget), std::to_string(budget));
    ASSERT_TRUE(result);
    EXPECT_EQ(result->counts.cases, cases) << budget;
    EXPECT_EQ(result->counts.evaluations, evaluations) << budget;
    EXPECT_EQ(result->end_reason, "budget");
    EXPECT_EQ(observer_.last.phase == CaseRole::training ? observer_.last.done : cases, cases);
  }
}

TEST_F(RunTest, DerivativesAreReplayedBitForBit) {
  const RunPlan plan = make_plan("articulated", 54);
  run(plan, "whole", 1);
  int starts = 0;
  for (bool done = false; !done; ++starts) {
    ASSERT_LT(starts, 100);
    StopSignal stop;
    StoppingObserver observer(stop, 1);  // after the first new evaluation
    done = execute_run({plan, temporary_ / "pieces", 2, {}}, stop, observer).has_value();
  }
  EXPECT_GT(starts, 3) << "the run was never interrupted";
  const JournalContent whole = read("whole");
  const JournalContent pieces = read("pieces");
  expect_same_evaluations(whole, pieces);
  int with_jacobian = 0;
  for (std::size_t i = 0; i < whole.training.size(); ++i) {
    const EvaluationRecord& record = whole.training[i];
    EXPECT_EQ(record.with_jacobian, pieces.training[i].with_jacobian);
    EXPECT_EQ(record.with_jacobian, !record.evaluation.jacobian.empty());
    EXPECT_EQ(record.with_jacobian, i % 4 == 0);
    EXPECT_TRUE(same_bits(record.evaluation.jacobian, pieces.training[i].evaluation.jacobian));
    EXPECT_EQ(record.calc_charge(), record.with_jacobian ? 12U : 2U);
    with_jacobian += record.with_jacobian ? 1 : 0;
  }
  EXPECT_EQ(with_jacobian, 3);
  EXPECT_EQ(read_result("whole"), read_result("pieces"));
}

TEST_F(RunTest, AReplayThatAsksForOtherDerivativesIsRefused) {
  RunPlan plan = make_plan("articulated", 54);
  StopSignal stop;
  StoppingObserver observer(stop, 1);  // after the first new evaluation
  EXPECT_FALSE(execute_run({plan, temporary_ / "a", 2, {}}, stop, observer));
  class Plain : public Optimizer {
   public:
    void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
      std::vector<double> x;
      for (const DecisionVariable& variable : evaluator.problem().variables) {
        x.push_back(variable.start);
      }
      evaluator.evaluate({&x, 1});
    }
  };
  plan.optimizer.make = [](const Options&) { return std::make_unique<Plain>(); };
  try {
    run(plan, "a");
    ADD_FAILURE() << "it went on";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("one was asked for with derivatives, the other without"));
  }
}

TEST_F(RunTest, ExactDerivativesOfAnEngineWithoutThemAreRefusedBeforeThereIsAFolder) {
  RunPlan plan = make_small_plan("random");
  plan.optimizer = find_optimizer("ceres:lm");
  if (!plan.optimizer.unavailable.empty()) {
    GTEST_SKIP() << plan.optimizer.unavailable;
  }
  plan.options = Options::parse("ceres:lm", plan.optimizer.options,
                                std::vector<std::string>{"derivatives=exact"});
  EXPECT_THAT(usage_error_of([&] { run(plan, "a"); }),
              HasSubstr("problem q1-complex offers no exact derivatives: engine 'ode' computes no "
                        "derivatives; choose --engine articulated, which does; or use "
                        "derivatives=differences"));
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "a"));
}

// The torque and its derivative are part of the objective.
TEST(TrackingJacobian, AgreesWithDifferencesOfTheResiduals) {
  for (const char* objective : {"error", "error_and_torque"}) {
    const LoadedProblem loaded = load_problem(
        "q1-complex", std::vector<std::string>{"workspace.points=4", "physics.engine=articulated",
                                               "objective.kind=" + std::string(objective),
                                               "objective.torque_weight=0.3"});
    const Problem& problem = *loaded.problem;
    ASSERT_TRUE(problem.description().has_jacobian);
    std::vector<double> x;
    for (const DecisionVariable& variable : problem.description().variables) {
      x.push_back(variable.start * (variable.lower < 0 ? 1.1 : 1.3));
    }
    const CaseBlock block{CaseRole::training, "train/1", {0, 3}};
    const Evaluation there = problem.evaluate(x, block, true);
    EXPECT_TRUE(problem.evaluate(x, block).jacobian.empty());
    ASSERT_EQ(there.jacobian.size(), there.residuals.size() * x.size());
    EXPECT_EQ(there.residuals, problem.evaluate(x, block).residuals);
    int smooth = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto calc_slopes = [&](double step) {
        std::vector<double> shifted = x;
        shifted[i] = x[i] * (1 + step);
        std::vector<double> slopes = problem.evaluate(shifted, block).residuals;
        shifted[i] = x[i] * (1 - step);
        const auto below = problem.evaluate(shifted, block).residuals;
        for (std::size_t k = 0; k < slopes.size(); ++k) {
          slopes[k] = (slopes[k] - below[k]) / (2 * step);
        }
        return slopes;
      };
      const auto wide = calc_slopes(1e-5);
      const auto narrow = calc_slopes(0.5e-5);
      for (std::size_t k = 0; k < wide.size(); ++k) {
        const double scale = std::max(std::abs(wide[k]), there.residuals[k]);
        if (std::abs(wide[k] - narrow[k]) < 3e-6 * scale) {
          ++smooth;
          EXPECT_NEAR(there.jacobian[k * x.size() + i] * x[i], narrow[k], 1e-5 * scale);
        }
      }
    }
    EXPECT_GT(smooth, 0.8 * static_cast<double>(there.jacobian.size()));
  }
}

}  // namespace
}  // namespace armwright
