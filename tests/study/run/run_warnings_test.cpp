// The warnings of a user's problem are told on every way out of a run.
#include <gmock/gmock.h>

#include <algorithm>
#include <utility>

#include "base/expect_error.hpp"
#include "process/json_message.hpp"
#include "study/own_problem.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kWarning = "warning: no mesh; it printed: angle 0";

RunPlan make_plan(const PrintingServer::Fails& fails) {
  RunPlan plan = make_small_plan("random", 20);
  UserDescription description = describe_own();
  description.is_deterministic = false;  // so that every judgement is simulated
  plan.problem = make_printing_problem(description, fails);
  plan.schedule = plan.problem.schedule;
  return plan;
}

TEST_F(RunTest, TellsEachWarningOnce) {
  ASSERT_TRUE(run(make_plan([](const CaseJob&) { return true; }), "a", 1));
  EXPECT_EQ(std::ranges::count(observer_.messages, kWarning), 1);
}

TEST_F(RunTest, TellsTheWarningsOfABatchThatBreaksTheContract) {
  bool has_failed = false;
  const RunPlan plan = make_plan([&](const CaseJob&) -> bool {
    if (has_failed) {
      throw ProtocolError("answers nonsense");
    }
    has_failed = true;
    return true;
  });
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(plan, "a", 1); }),
              HasSubstr("answers nonsense"));
  EXPECT_THAT(observer_.messages, Contains(kWarning));
}

TEST_F(RunTest, TellsTheWarningsOfAJudgementThatAStopEnds) {
  StopSignal stop;
  bool has_failed = false;
  const RunPlan plan = make_plan([&](const CaseJob& job) {
    if (job.block->role == CaseRole::test) {
      stop.request(StopReason::interrupted);
      throw WorkStopped();  // as a program does that a stop ends
    }
    return job.block->role == CaseRole::validation && !std::exchange(has_failed, true);
  });
  EXPECT_FALSE(execute_run({plan, temporary_ / "a", 1, {"armwright"}}, stop, observer_));
  EXPECT_THAT(observer_.messages, Contains(kWarning));
}

}  // namespace
}  // namespace armwright
