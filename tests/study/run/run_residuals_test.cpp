// Tests that residuals are made and recorded only for optimizers that use them.
#include <gmock/gmock.h>

#include <functional>

#include "optimizers/table/multistart.hpp"
#include "study/run/run.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::IsEmpty;
using testing::SizeIs;

// Asks for a few points and stores the residuals that it gets.
class AskingOptimizer : public Optimizer {
 public:
  explicit AskingOptimizer(std::vector<std::vector<double>>* residuals) : residuals_(residuals) {}
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    std::vector<double> x;
    for (const DecisionVariable& variable : evaluator.problem().variables) {
      x.push_back(variable.start);
    }
    for (int i = 0; i < 3 && !evaluator.stopped(); ++i) {
      x[0] *= 1.01;
      for (Score& score : evaluator.evaluate({&x, 1})) {
        residuals_->push_back(std::move(score.residuals));
      }
    }
  }

 private:
  std::vector<std::vector<double>>* residuals_;
};

// Two cases of three points, of which two count.
RunPlan make_asking_plan(const std::function<void(OptimizerRow&)>& change,
                         std::vector<std::vector<double>>& residuals) {
  RunPlan plan = make_small_plan("random", 6);
  plan.problem = load_problem(
      "q1-complex", std::vector<std::string>{"workspace.points=3", "sets.validation_cases=1",
                                             "sets.test_cases=1"});
  OptimizerRow row;
  row.name = "asking";
  row.capabilities.local = true;
  row.make = [&residuals](const Options&) { return std::make_unique<AskingOptimizer>(&residuals); };
  change(row);
  plan.optimizer = row;
  plan.options = Options::parse(row.name, row.options, {});
  return plan;
}

class RunResiduals : public RunTest {
 protected:
  // The optimizer's residuals are those recorded; validation and test have none.
  std::vector<std::vector<double>> run_asking(const std::function<void(OptimizerRow&)>& change) {
    std::vector<std::vector<double>> told;
    const std::string folder = std::to_string(runs_++);
    run(make_asking_plan(change, told), folder);
    const JournalContent journal = read(folder);
    EXPECT_EQ(journal.training.size(), told.size());
    for (std::size_t i = 0; i < told.size(); ++i) {
      EXPECT_TRUE(same_bits(journal.training[i].evaluation.residuals, told[i])) << i;
    }
    EXPECT_FALSE(journal.judgements.empty());
    for (const EvaluationRecord& record : journal.judgements) {
      EXPECT_THAT(record.evaluation.residuals, IsEmpty());
    }
    return told;
  }

 private:
  int runs_ = 0;
};

TEST_F(RunResiduals, NoneForAnOptimizerThatDoesNotUseThem) {
  const auto told = run_asking([](OptimizerRow&) {});
  ASSERT_THAT(told, SizeIs(3));
  EXPECT_THAT(told, Each(IsEmpty()));
}

TEST_F(RunResiduals, OneForEachPointThatCountsForAnOptimizerThatUsesThem) {
  const auto told = run_asking([](OptimizerRow& row) { row.capabilities.residuals = true; });
  ASSERT_THAT(told, SizeIs(3));
  EXPECT_THAT(told, Each(SizeIs(4)));
  EXPECT_EQ(told, run_asking([](OptimizerRow& row) { row.requirements.residuals = true; }));
}

TEST_F(RunResiduals, MultistartPassesThemOn) {
  const auto told = run_asking([](OptimizerRow& row) {
    row.capabilities.residuals = true;
    row = make_multistart_row(row);
  });
  EXPECT_THAT(told, SizeIs(3));  // the budget is 6 cases, and a point costs 2
  EXPECT_THAT(told, Each(SizeIs(4)));
}

TEST_F(RunResiduals, ResumingAnswersFromTheJournalWithThem) {
  const auto use = [](OptimizerRow& row) { row.capabilities.residuals = true; };
  std::vector<std::vector<double>> first;
  std::vector<std::vector<double>> again;
  run(make_asking_plan(use, first), "a");
  std::filesystem::remove(temporary_ / "a" / "result.json");
  const auto result = run(make_asking_plan(use, again), "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->counts.replayed, 3U);
  EXPECT_EQ(first, again);
}

}  // namespace
}  // namespace armwright
