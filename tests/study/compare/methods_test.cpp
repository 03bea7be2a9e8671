// Methods: the same optimizer spends the same budget in another way.
#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "sim/tracking/design.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kHead = R"(problems = ["q1-complex"]
schedule = "fixed:5"
replicates = 2
budget = 100
checkpoints = 4
baselines = false
set = ["physics.engine=articulated", "workspace.points=4", "sets.test_cases=6",
       "sets.validation_cases=3"]
)";

TEST(StudyMethods, SpendTheSameBudgetOnTheSameCasesFromTheSameStart) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string(kHead) + R"(
[[optimizer]]
name = "ga"
label = "five fixed"
[[optimizer]]
name = "ga"
label = "one fresh"
schedule = "fresh:1"
)");
  const RunPlan fixed = make_run_plan(plan, {0, 0, 1});
  const RunPlan fresh = make_run_plan(plan, {0, 1, 1});
  EXPECT_EQ(to_text(fixed.schedule), "fixed:5");
  EXPECT_EQ(to_text(fresh.schedule), "fresh:1");
  EXPECT_EQ(fixed.budget, fresh.budget);
  EXPECT_EQ(fixed.problem.sets.training, fresh.problem.sets.training);
  EXPECT_EQ(fixed.problem.sets.test, fresh.problem.sets.test);
  EXPECT_EQ(fixed.problem.problem->description().variables.front().start,
            fresh.problem.problem->description().variables.front().start);
  EXPECT_NE(fixed.seed, fresh.seed);
}

// Returns the arm with which a cell begins.
ArmDesign make_start(const RunPlan& run) {
  std::vector<double> x;
  for (const DecisionVariable& variable : run.problem.problem->description().variables) {
    x.push_back(variable.start);
  }
  return run.problem.tracking()->make_design(x);
}

TEST(StudyMethods, WithOtherControllersBeginFromTheSamePid) {
  const TemporaryFolder folder;
  std::string toml = R"(problems = ["q2-e6"]
schedule = "fixed:5"
replicates = 4
budget = 100
baselines = false
set = ["physics.engine=articulated", "workspace.points=4"]
)";
  // The problem's own version is the first. `fuzzy` lacks the integral of its PID.
  const std::vector<std::string> names = {"pid",         "pid_filtered",        "pi2d",
                                          "pid_gravity", "pid_computed_torque", "cascade",
                                          "neural",      "fuzzy_reference"};
  for (const std::string& name : names) {
    toml += "[[optimizer]]\nname = \"cmaes\"\nlabel = \"" + name +
            "\"\nset = [\"control.controller=" + name + "\"]\n";
  }
  const StudyPlan plan = load_plan(folder, toml);
  for (const Cell& cell : list_cells(plan)) {
    SCOPED_TRACE(names[cell.optimizer] + " " + std::to_string(cell.replicate));
    const ArmDesign pid = make_start(make_run_plan(plan, {0, 0, cell.replicate}));
    const RunPlan run = make_run_plan(plan, cell);
    const TrackingProblem& own = *run.problem.tracking();
    const ArmDesign start = make_start(run);
    const ArmDesign converted =
        convert_design(pid, names[cell.optimizer], own.config().task.control_period_s);
    EXPECT_EQ(own.make_vector(start), own.make_vector(converted));
    // A small spread, so that no cell begins with an arm that falls down.
    for (const TrackingResult& result : own.track(start, own.get_set("test/1"), 0, 5, {})) {
      EXPECT_LT(result.mean_error_m, kFailureError_m);
    }
  }
}

// Link lengths and speed, which do not belong to the controller, are the same at the start as well.
TEST(StudyMethods, WithOtherControllersBeginWithTheSameArm) {
  const TemporaryFolder folder;
  std::string toml = kHead;
  toml.replace(toml.find("set = ["), 7,
               "set = [\"variables.optimize=['gains', 'length_scale']\", "
               "\"variables.task=['speed']\", ");
  const StudyPlan plan = load_plan(folder, toml +
                                               "[[optimizer]]\nname = 'ga'\n"
                                               "[[optimizer]]\nname = 'ga'\nlabel = 'neural'\n"
                                               "set = ['control.controller=neural']\n");
  const ArmDesign pid = make_start(make_run_plan(plan, {0, 0, 1}));
  const ArmDesign neural = make_start(make_run_plan(plan, {0, 1, 1}));
  EXPECT_EQ(neural.controller, "neural");
  EXPECT_NE(pid.joints[0].length_scale, 1);
  EXPECT_EQ(pid.joints[0].length_scale, neural.joints[0].length_scale);
  EXPECT_EQ(pid.speed_m_per_s, neural.speed_m_per_s);
}

TEST(StudyMethods, WhoseStartIsNoPidIsRefused) {
  const TemporaryFolder folder;
  std::string toml = kHead;
  toml.replace(toml.find("set = ["), 7, "set = [\"control.controller=pi2d\", ");
  EXPECT_THAT(usage_error_of([&] {
                load_plan(folder, toml +
                                      "[[optimizer]]\nname = 'ga'\nlabel = 'plain'\n"
                                      "set = ['control.controller=pid']\n");
              }),
              HasSubstr("optimizer plain on q1-complex: the start design is for controller "
                        "'pi2d'"));
}

TEST(StudyMethods, ChangeNothingButTraining) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& method, const std::string& message) {
    EXPECT_THAT(usage_error_of([&] {
                  load_plan(folder, std::string(kHead) + "[[optimizer]]\nname = 'ga'\n" + method);
                }),
                HasSubstr(message));
  };
  expect("set = ['sets.test_cases=1']\n",
         "sets.test_cases is the same for every optimizer of a comparison");
  expect("set = ['task.speed_m_per_s=1']\n",
         "task.speed_m_per_s is the same for every optimizer of a comparison");
  expect("set = ['objective.kind=error']\n", "objective.kind is the same for every optimizer");
  expect("set = ['control.period_s=0.005']\n",
         "control.period_s is the same for every optimizer of a comparison");
  expect("set = ['control={controller=\"pid\",period_s=0.005}']\n",
         "control is the same for every optimizer of a comparison");
  expect("set = ['schedule.kind=fresh']\n", "for schedule.kind write schedule = \"KIND:K\"");
  expect("schedule = 'often:1'\n", "schedule is 'often:1'; it must be fresh:K");
  expect("schedule = 'fixed:101'\n", "a budget of 100 cases does not pay for one evaluation");
  expect("schedule = 'fresh:1'\n[[optimizer]]\nname = 'nlopt:cobyla'\nschedule = 'fresh:1'\n",
         "optimizer 'nlopt:cobyla' has no generations");
}

TEST(StudyMethods, MayPerturbWhatIsNotJudged) {
  const TemporaryFolder folder;
  const auto load_method = [&](const std::string& problem, const std::string& method) {
    std::string toml = kHead;
    toml.replace(toml.find("set = ["), 7, "set = [" + problem);
    return load_plan(folder,
                     toml + "[[optimizer]]\nname = 'ga'\nlabel = 'own'\nset = [" + method + "]\n");
  };
  const auto expect_refused = [&](const std::string& problem, const std::string& method) {
    EXPECT_THAT(usage_error_of([&] { load_method(problem, method); }),
                HasSubstr("optimizer own on q1-complex: its designs would be judged on other "
                          "plants"))
        << method;
  };
  load_method("", "'perturbation.mass_relative=0'");
  load_method("", "'perturbation.set=plant/2'");
  load_method("", "'perturbation.mass_relative=0.1', 'perturbation.apply_to=training'");
  load_method("'perturbation.mass_relative=0.1',", "'perturbation.apply_to=judging'");
  expect_refused("", "'perturbation.mass_relative=0.1'");
  expect_refused("", "'perturbation.mass_relative=0.1', 'perturbation.apply_to=judging'");
  expect_refused("'perturbation.mass_relative=0.1',", "'perturbation.mass_relative=0'");
  expect_refused("'perturbation.mass_relative=0.1',", "'perturbation.mass_relative=0.2'");
  expect_refused("'perturbation.mass_relative=0.1',", "'perturbation.set=plant/2'");
  expect_refused("'perturbation.mass_relative=0.1',", "'perturbation.apply_to=training'");
}

TEST_F(StudyTest, MethodsAreComparedLikeOptimizers) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(folder, std::string("value = \"failures\"\n") + kHead + R"(
optimizers = ["nlopt:cobyla"]
[[optimizer]]
name = "ga"
label = "ga, one fresh case"
options = ["population=6"]
schedule = "fresh:1"
[selection]
along = true
)");
  const StudyResult result = study(plan, "study");
  EXPECT_TRUE(result.missing.empty());
  for (const CellOutcome& cell : result.cells) {
    EXPECT_LE(cell.cases, 100u);
    EXPECT_EQ(cell.errors.cases, 6u);
    EXPECT_EQ(cell.curve.back().budget, 100);
    EXPECT_EQ(cell.value, static_cast<double>(cell.errors.failures) / 6);
    EXPECT_EQ(cell.choices.back().failures,
              cell.errors.failures);  // judged along, it is the winner
  }
  EXPECT_EQ(result.problems[0].quantity.name, "share of failed test cases");
  EXPECT_THAT(describe_verdict(plan, result),
              Contains(HasSubstr("Methods spend the same budget in ways of their own")));
  const auto manifest =
      read_tree(temporary_ / "study" / make_cell_path(plan, {0, 1, 1})).at("manifest.json");
  EXPECT_THAT(manifest, HasSubstr("\"kind\": \"fresh\""));
}

}  // namespace
}  // namespace armwright
