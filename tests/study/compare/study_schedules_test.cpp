// The schedule "own": every optimizer gets the schedule that suits it.
#include "study/compare/study_schedules.hpp"

#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kOwnHead = R"(problems = ["q1-complex"]
schedule = "own"
replicates = 2
budget = 60
checkpoints = 3
set = ["physics.engine=articulated", "workspace.points=4", "sets.test_cases=4",
       "sets.validation_cases=3"]
)";
constexpr const char* kOwnOptimizers = R"(
[[optimizer]]
name = "ga"
options = ["population=6"]
[[optimizer]]
name = "nlopt:cobyla"
[[optimizer]]
name = "ga"
label = "ga, fixed"
options = ["population=6"]
schedule = "fixed:3"
)";

std::string get_schedule_text(const StudyPlan& plan, std::size_t problem, std::size_t optimizer) {
  return to_text(make_run_plan(plan, {problem, optimizer, 1}).schedule);
}

TEST(OwnSchedules, AreFreshForGenerationsAndFixedForTheOthers) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string(kOwnHead) + kOwnOptimizers);
  EXPECT_EQ(get_schedule_text(plan, 0, 0), "fresh:1");
  EXPECT_EQ(get_schedule_text(plan, 0, 1), "fixed:5");
  EXPECT_EQ(get_schedule_text(plan, 0, 2), "fixed:3");  // a method keeps its own
  EXPECT_EQ(get_schedule_text(plan, 0, 3), "fixed:5");  // the baseline random
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    EXPECT_EQ(make_run_plan(plan, {0, o, 1}).budget, 60);
  }
  EXPECT_EQ(list_checkpoints(plan, 0).back(), 60);
}

TEST(OwnSchedules, AreRecordedForEveryOptimizer) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string(kOwnHead) + kOwnOptimizers);
  std::string text = to_toml(plan);
  EXPECT_THAT(
      text, testing::AllOf(HasSubstr("schedule = \"own\""), HasSubstr("own_schedule = \"fresh:1\""),
                           HasSubstr("own_schedule = \"fixed:5\"")));
  EXPECT_EQ(to_toml(load_plan(folder, text)), text);
  // The recorded schedule counts, even if this version would choose another one.
  text.erase(0, text.find('\n') + 1);
  text.replace(text.find("\"fresh:1\""), 9, "\"fresh:2\"");
  EXPECT_EQ(get_schedule_text(load_plan(folder, text), 0, 0), "fresh:2");
}

TEST(OwnSchedules, CanBeThoseOfOneProblem) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, R"(budget = 60
schedule = "fixed:2"
optimizers = ["ga"]
[[problem]]
name = "q1-complex"
schedule = "own"
[[problem]]
name = "q1-triangular"
[[problem]]
name = "sphere"
schedule = "own"
)");
  EXPECT_EQ(get_schedule_text(plan, 0, 0), "fresh:1");
  EXPECT_EQ(get_schedule_text(plan, 1, 0), "fixed:2");
  EXPECT_EQ(get_schedule_text(plan, 2, 0), "fixed:1");  // a function has no training cases
  EXPECT_EQ(get_schedule_text(plan, 2, 1), "fixed:1");
}

TEST(OwnSchedules, OfANewProblemDoNotChangeTheRecordedStudy) {
  const TemporaryFolder folder;
  const std::string study =
      "budget = 60\nreplicates = 2\noptimizers = ['ga']\n"
      "[[problem]]\nname = 'q1-complex'\nschedule = 'fixed:2'\n";
  StudyFolder(folder / "study", load_plan(folder, study));
  const StudyPlan grown =
      load_plan(folder, study + "[[problem]]\nname = 'q1-triangular'\nschedule = 'own'\n");
  const StudyFolder opened(folder / "study", grown);
  EXPECT_THAT(opened.additions(), Contains("problem q1-triangular"));
}

TEST(OwnSchedules, AreNamedAmongTheSchedulesThatAreAllowed) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& text, const std::string& message) {
    EXPECT_THAT(usage_error_of([&] { load_plan(folder, text); }), HasSubstr(message));
  };
  expect("problems = ['q1-complex']\noptimizers = ['ga']\nbudget = 60\nschedule = 'owns'\n",
         "or own (fresh:1 for every optimizer that has generations, fixed:5 for the others)");
  expect("problems = ['q1-complex']\nbudget = 60\n[[optimizer]]\nname = 'ga'\nschedule = 'own'\n",
         "schedule is 'own'; it must be fresh:K");
}

TEST_F(StudyTest, OwnSchedulesAreComparedAndTheVerdictNamesThem) {
  const StudyPlan plan = load_plan(temporary_, std::string(kOwnHead) + kOwnOptimizers);
  const StudyResult result = study(plan, "study");
  EXPECT_TRUE(result.missing.empty());
  EXPECT_THAT(describe_verdict(plan, result),
              Contains("On q1-complex ga has the schedule fresh:1, ga, fixed has the schedule "
                       "fixed:3, the others fixed:5."));
}

}  // namespace
}  // namespace armwright
