// Tests runs on problems with requirements: optimizers keep the constraints, the bytes are the same
// for any number of threads and after an interruption, and the result describes its winner.
#include <gmock/gmock.h>

#include "optimizers/table/optimizer_table.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::Field;
using testing::SizeIs;

// The gains of two joints on a small case. Without the requirements the best designs chatter.
std::string make_requirements(const std::string& use) {
  const std::string end = ", use='" + use + "'}";
  return "requirement=[{quantity='overshoot', limit_relative=0.03" + end +
         ", {quantity='settling_time', limit_s=0.1, band_m=0.005" + end +
         ", {quantity='peak_torque', limit_n_m=30000" + end +
         ", {quantity='joint_speed', limit_rad_per_s=4.5" + end + "]";
}

class RequirementRun : public RunTest {
 protected:
  RunPlan make_plan(const std::string& use, std::int64_t budget = 3000) {
    RunPlan plan;
    plan.problem = load_problem(
        "q1-complex",
        std::vector<std::string>{"physics.engine=articulated", "task.ik_bug=false",
                                 "workspace.points=6", "sets.validation_cases=40",
                                 "sets.test_cases=40", "variables.start=table-a5",
                                 "variables.bounds_factor=30", "variables.optimize=[]",
                                 "variables.joint=[{name='joint_2', optimize=['gains']},"
                                 "{name='joint_3', optimize=['gains']}]",
                                 make_requirements(use)});
    plan.optimizer = load_optimizer("cmaes");
    plan.options = Options::parse("cmaes", plan.optimizer.options, {});
    plan.budget = budget;
    plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 10};
    return plan;
  }
};

TEST_F(RequirementRun, TheWinnerKeepsThemWhereTheUnconstrainedOneDoesNot) {
  const auto free = run(make_plan("report"), "free");
  ASSERT_TRUE(free && free->winner);
  EXPECT_TRUE(free->constraints.empty());
  bool missed = false;
  for (const JudgedRequirement& one : judge_requirements(free->requirements, free->test)) {
    missed |= one.grade == RequirementGrade::missed;
  }
  EXPECT_TRUE(missed);
  const auto held = run(make_plan("constraint"), "held");
  ASSERT_TRUE(held && held->winner);
  EXPECT_THAT(held->constraints, SizeIs(4));
  EXPECT_TRUE(is_proven_feasible(held->test));
  EXPECT_THAT(judge_requirements(held->requirements, held->test),
              Each(Field(&JudgedRequirement::grade,
                         testing::AnyOf(RequirementGrade::met, RequirementGrade::tight))));
}

TEST_F(RequirementRun, IsTheSameForAnyNumberOfThreadsAndAfterAnInterruption) {
  const RunPlan plan = make_plan("constraint", 600);
  run(plan, "one", 1);
  run(plan, "five", 5);
  expect_same_evaluations(read("one"), read("five"));
  EXPECT_EQ(read_result("one"), read_result("five"));
  StopSignal stop;
  StoppingObserver stopping(stop, 250);
  EXPECT_FALSE(
      execute_run({plan, temporary_ / "broken", 2, {"armwright", "optimize"}}, stop, stopping));
  EXPECT_LT(read("broken").training.size(), read("one").training.size());
  run(plan, "broken");
  expect_same_evaluations(read("one"), read("broken"));
  EXPECT_EQ(read_result("one"), read_result("broken"));
}

TEST_F(RequirementRun, TheResultHoldsThemAndReadsBack) {
  const auto result = run(make_plan("report", 200), "a");
  ASSERT_TRUE(result);
  const RunResult read_back = load_result(temporary_ / "a");
  ASSERT_THAT(read_back.requirements, SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read_back.requirements[i].metric, result->requirements[i].metric);
    EXPECT_EQ(read_back.requirements[i].limit.value, result->requirements[i].limit.value);
    EXPECT_EQ(read_back.requirements[i].limit.quantity.name,
              result->requirements[i].limit.quantity.name);
    EXPECT_FALSE(read_back.requirements[i].is_constraint);
  }
  EXPECT_EQ(to_json(read_back), read_result("a"));
  // Results of problems without requirements have no such keys.
  run(make_small_plan("ga", 16), "plain");
  EXPECT_EQ(read_result("plain").find("requirement"), std::string::npos);
}

}  // namespace
}  // namespace armwright
