// Tests that the winner of a single run is confirmed on further validation cases.
#include <fmt/format.h>

#include <map>
#include <memory>

#include "study/racing_support.hpp"

namespace armwright {
namespace {

// Proposes the whole numbers below `points`, the largest first, and ends.
class Counts : public Optimizer {
 public:
  explicit Counts(int points) : points_(points) {}
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    for (int i = points_ - 1; i >= 0; --i) {
      evaluator.evaluate(std::vector<std::vector<double>>{{static_cast<double>(i)}});
    }
  }

 private:
  int points_;
};

// Of the cases of the validation set, design 0 fails case 25, and design 1 fails case 95.
// All of them pass the first ten. A smaller number has a smaller error.
class ConfirmedWinner : public RunTest {
 protected:
  static RunPlan make_plan(int points, double failure_error = 10) {
    const auto calc_error = [](std::span<const double> x, const CaseBlock& block,
                               std::uint64_t number) {
      const bool fails = block.role == CaseRole::validation &&
                         ((x[0] == 0 && number == 25) || (x[0] == 1 && number == 95));
      return fails ? 100 : x[0];
    };
    RunPlan plan;
    plan.problem.name = "edge";
    plan.problem.problem = std::make_shared<MeanProblem>(1, calc_error, failure_error);
    plan.problem.resolved_json = "{}";
    plan.problem.sets.validation_cases = 10;
    plan.problem.sets.test_cases = 5;
    plan.optimizer.name = "counts";
    plan.optimizer.make = [points](const Options&) { return std::make_unique<Counts>(points); };
    plan.budget = points;
    plan.schedule = *read_schedule("fixed:1");
    return plan;
  }
  static double get_winner(const RunResult& result) {
    return result.judged.at(result.winner.value()).candidate.x[0];
  }
  // Returns the further cases and the failures among them of each design.
  static std::map<double, std::pair<std::uint64_t, std::uint64_t>> list_further(
      const RunResult& result) {
    std::map<double, std::pair<std::uint64_t, std::uint64_t>> further;
    for (const JudgedCandidate& judged : result.judged) {
      further[judged.candidate.x[0]] = {judged.further_cases, judged.further_failures};
    }
    return further;
  }
};

TEST_F(ConfirmedWinner, PassesTenTimesTheValidationCases) {
  const auto result = run(make_plan(5), "run");
  ASSERT_TRUE(result);
  EXPECT_EQ(get_winner(*result), 2);
  EXPECT_EQ(list_further(*result),
            (std::map<double, std::pair<std::uint64_t, std::uint64_t>>{
                {0, {20, 1}}, {1, {90, 1}}, {2, {90, 0}}, {3, {0, 0}}, {4, {0, 0}}}));
  EXPECT_EQ(parse_result(read_result("run"), "result.json").judged[0].further_cases,
            result->judged[0].further_cases);
}

TEST_F(ConfirmedWinner, HasTheSmallestShareOfFailuresIfAllFail) {
  const auto result = run(make_plan(2), "run");
  ASSERT_TRUE(result);
  EXPECT_EQ(get_winner(*result), 1);  // one of 100 cases, and design 0 fails one of 30
}

TEST_F(ConfirmedWinner, IsNotConfirmedIfNoCaseCanFailOrInAComparison) {
  const auto unlimited = run(make_plan(5, std::numeric_limits<double>::infinity()), "unlimited");
  ASSERT_TRUE(unlimited);
  EXPECT_EQ(get_winner(*unlimited), 0);
  StopSignal stop;
  const auto cell = execute_run(
      {make_plan(5), temporary_ / "cell", 1, {"armwright"}, DerivedFiles::winner}, stop, observer_);
  ASSERT_TRUE(cell);
  EXPECT_EQ(get_winner(*cell), 0);
}

TEST_F(ConfirmedWinner, IsTheSameAfterEveryInterruption) {
  ASSERT_TRUE(run(make_plan(5), "whole"));
  for (std::uint64_t after = 1; after <= 40; after += 3) {
    const std::string folder = fmt::format("cut-{}", after);
    StopSignal stop;
    StoppingObserver observer(stop, after);
    execute_run({make_plan(5), temporary_ / folder, 1, {"armwright"}}, stop, observer);
    ASSERT_TRUE(run(make_plan(5), folder));
    EXPECT_EQ(read_result(folder), read_result("whole")) << after;
  }
}

}  // namespace
}  // namespace armwright
