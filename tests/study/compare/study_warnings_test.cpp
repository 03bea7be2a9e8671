// The warnings of a user's problem in a comparison: each cell tells its own, and with ranks the
// process that simulates tells them.
#include <gmock/gmock.h>

#include <algorithm>

#include "study/compare/study_support.hpp"
#include "study/executor/coordinator.hpp"
#include "study/executor/memory_transport.hpp"
#include "study/matrix/chunks.hpp"
#include "study/own_problem.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

bool fail_always(const CaseJob& /*job*/) {
  return true;
}

class StudyWarnings : public StudyTest {
 protected:
  static StudyPlan make_plan(const PrintingServer::Fails& fails) {
    StudyRequest request = make_small_request();
    request.problems = {"sphere"};
    request.optimizers = {"random"};
    request.replicates = 1;
    request.budget = 8;
    request.baselines = false;
    StudyPlan plan = make_study_plan(request);
    plan.problems.front().loaded = make_printing_problem(describe_own(), fails);
    plan.problems.front().schedule = plan.problems.front().loaded.schedule;
    return plan;
  }
};

TEST_F(StudyWarnings, ThoseOfTheMeasurementBelongToNoCell) {
  // Only the problem's own start fails; the cells have other ones.
  const StudyPlan plan =
      make_plan([](const CaseJob& job) { return job.x[0] == 2 && job.x[1] == 2; });
  measure_cell_durations_s(plan);
  run_all(plan, "study", 1);
  EXPECT_THAT(observer_.messages, Not(Contains(HasSubstr("no mesh"))));
}

TEST_F(StudyWarnings, TheMeasurementSuppressesNoneOfTheCells) {
  const StudyPlan plan = make_plan(fail_always);
  measure_cell_durations_s(plan);
  find_warnings(*plan.problems.front().loaded.problem)->take();
  run_all(plan, "study", 1);
  EXPECT_THAT(observer_.messages,
              Contains(HasSubstr("random/r01: warning: no mesh; it printed: angle 0")));
}

TEST_F(StudyWarnings, ThoseOfTheTestSetBelongToTheirCell) {
  run_all(make_plan([](const CaseJob& job) { return job.block->role == CaseRole::test; }), "study",
          1);
  EXPECT_THAT(observer_.messages, Contains(HasSubstr("random/r01: warning: no mesh")));
}

TEST_F(StudyWarnings, WithRanksTheFirstOneTellsThose) {
  const StudyPlan plan = make_plan(fail_always);
  MemoryNetwork network(1);
  MemoryTransport transport(network, 0);
  std::vector<const Problem*> problems;
  for (const LoadedProblem* loaded : list_problems(plan)) {
    problems.push_back(loaded->problem.get());
  }
  const auto path = temporary_ / "study";
  StudyFolder folder(path, plan);
  StopSignal stop;
  Coordinator coordinator(transport, problems, "{}", {}, [](const std::string&) {});
  run_cells(plan, path, 1, stop, observer_, &coordinator);
  EXPECT_EQ(std::ranges::count(observer_.messages,
                               "problem 'own': warning: no mesh; it printed: angle 0"),
            1);
}

}  // namespace
}  // namespace armwright
