// Tests runs whose optimizer or evaluations fail, and runs with several objectives.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "base/expect_error.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

// Moves outwards and back again, in generations of four. Fails after the given number of
// evaluations, unless the number is negative.
class FailingOptimizer : public Optimizer {
 public:
  FailingOptimizer(int evaluations, std::string message)
      : evaluations_(evaluations), message_(std::move(message)) {}
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    std::vector<double> x;
    for (const DecisionVariable& variable : evaluator.problem().variables) {
      x.push_back(variable.start);
    }
    for (int i = 0; !evaluator.stopped(); ++i) {
      if (i == evaluations_) {
        throw OptimizerFailure(message_);
      }
      if (i % 4 == 0) {
        evaluator.begin_generation();
      }
      x[0] *= i % 4 == 1 ? 1.1 : 0.95;
      evaluator.evaluate({&x, 1});
    }
  }

 private:
  int evaluations_;
  std::string message_;
};

RunPlan make_failing_plan(int evaluations, const std::string& message = "it fell over") {
  RunPlan plan;
  plan.problem = load_problem("sphere", std::vector<std::string>{"function.instance=0"});
  plan.optimizer.name = "failing";
  plan.optimizer.capabilities.generations = true;
  plan.optimizer.make = [=](const Options&) {
    return std::make_unique<FailingOptimizer>(evaluations, message);
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
  EXPECT_EQ(result->judged.size(), 3u);  // the improvements
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

// The evaluations of an earlier attempt are kept and judged, even if the next attempt fails
// earlier: at once, within a generation, at its end, or at the same place.
TEST_F(RunTest, AnAttemptThatFailsSoonerTakesNothingAway) {
  for (const bool fresh : {false, true}) {
    for (const int sooner : {0, 2, 4, 5, 8, 10}) {
      SCOPED_TRACE(fmt::format("fresh {}, fails after {}", fresh, sooner));
      const std::string folder = fmt::format("{}-{}", fresh, sooner);
      const auto make_plan = [&](int evaluations, const std::string& message) {
        RunPlan plan = make_failing_plan(evaluations, message);
        plan.schedule = {.kind = fresh ? Schedule::Kind::fresh : Schedule::Kind::fixed, .cases = 2};
        plan.budget = 36;
        return plan;
      };
      const auto first = run(make_plan(10, "it fell over"), folder);
      ASSERT_TRUE(first && first->winner);
      auto again = run(make_plan(sooner, "it fell over sooner"), folder);
      ASSERT_TRUE(again);
      EXPECT_EQ(again->counts.replayed, 10u);
      EXPECT_EQ(again->failure, "it fell over sooner");
      again->failure = first->failure;
      EXPECT_EQ(to_json(*again), to_json(*first));
      RunResult recorded = load_result(temporary_ / folder);
      recorded.failure = first->failure;
      EXPECT_EQ(to_json(recorded), to_json(*first));
      EXPECT_EQ(observer_.last.phase, CaseRole::test);
      EXPECT_EQ(read(folder).training.size(), 10u);
      // The attempt that failed earlier adds nothing.
      run(make_plan(-1, ""), folder);
      const std::string whole = fmt::format("whole-{}", folder);
      run(make_plan(-1, ""), whole);
      EXPECT_EQ(read_result(folder), read_result(whole));
    }
  }
}

TEST_F(RunTest, WhatIsRecordedBehindAGapCountsWhenTheNextAttemptFailsSooner) {
  run(make_failing_plan(10), "a");
  const JournalContent whole = read("a");
  const auto file = temporary_ / "a" / "journal";
  std::filesystem::remove(file);
  JournalContent nothing;
  Journal journal(file, nothing);
  for (const EvaluationRecord& record : whole.training) {
    if (record.index != 6) {
      journal.append(record);
    }
  }
  journal.close();
  const auto again = run(make_failing_plan(2), "a");
  ASSERT_TRUE(again && again->winner);
  EXPECT_EQ(again->counts.evaluations, 9u);
  EXPECT_EQ(again->counts.generations, 3u);
  EXPECT_EQ(again->judged.back().candidate.evaluation, 8u);
  run(make_failing_plan(-1), "a");
  run(make_failing_plan(-1), "whole");
  EXPECT_EQ(read_result("a"), read_result("whole"));
}

TEST_F(RunTest, AnAttemptThatFailsInALaterGenerationThanWasRecordedIsRefused) {
  run(make_failing_plan(7), "a");
  RunPlan other = make_failing_plan(0);
  other.optimizer.make = [](const Options&) -> std::unique_ptr<Optimizer> {
    class Hasty : public Optimizer {
      void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
        evaluator.begin_generation();
        evaluator.begin_generation();
        throw OptimizerFailure("it fell over");
      }
    };
    return std::make_unique<Hasty>();
  };
  const std::string before = read_result("a");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(other, "a"); }),
              HasSubstr("evaluation 0 of the journal is not what optimizer 'failing' asks for now: "
                        "its generation is over"));
  EXPECT_EQ(read_result("a"), before);
}

TEST_F(RunTest, SeveralObjectivesLeaveAFront) {
  RunPlan plan;
  plan.problem = load_problem(
      "q2-pareto", std::vector<std::string>{"physics.engine=ode", "workspace.points=4",
                                            "sets.validation_cases=2", "sets.test_cases=2"});
  plan.optimizer = load_optimizer("ga");
  plan.options =
      Options::parse("ga", plan.optimizer.options, std::vector<std::string>{"population=8"});
  plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 1};
  plan.budget = 40;
  const auto result = run(plan, "a");
  ASSERT_TRUE(result && result->winner);
  // No judged design dominates another one in training, except the ones with the best sums.
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
  EXPECT_EQ(usage_error_of([&] { run(plan, "a"); }),
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

}  // namespace
}  // namespace armwright
