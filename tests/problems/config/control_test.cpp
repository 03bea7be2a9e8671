// The [control] table: which controller a problem tunes, what its start is made of, and what its
// gains are as decision variables.
#include <gmock/gmock.h>

#include <fstream>

#include "base/expect_error.hpp"
#include "base/temporary_folder.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/problem_folder.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

LoadedProblem load_with_gains(const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {R"(variables.optimize=["gains", "effort_min", "effort_max"])"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return load_problem("q2-e6", all);
}

// Returns the settings under which a problem has the controller.
std::vector<std::string> list_settings_of(const std::string& controller) {
  std::vector<std::string> settings = {"control.controller=" + controller};
  const ControlInterface interface = find_controller(controller).interface;
  if (interface != ControlInterface::effort) {
    settings.push_back("control.interface=" +
                       control_interface_names()[static_cast<std::size_t>(interface)]);
    settings.push_back("physics.substeps=20");  // the drives' inner loops need them
  }
  return settings;
}

LoadedProblem load_under(const std::string& controller, std::vector<std::string> others = {}) {
  const std::vector<std::string> settings = list_settings_of(controller);
  others.insert(others.end(), settings.begin(), settings.end());
  return load_with_gains(others);
}

const DecisionVariable& get_variable(const LoadedProblem& loaded, const std::string& name) {
  for (const DecisionVariable& variable : loaded.problem->description().variables) {
    if (variable.name == name) {
      return variable;
    }
  }
  throw std::out_of_range(name);
}

TEST(Control, WithoutATableThereIsThePidOfTheStart) {
  const LoadedProblem loaded = load_with_gains({});
  EXPECT_EQ(loaded.tracking()->config().start.controller, "pid");
  EXPECT_EQ(loaded.tracking()->config().task.feed_forward, FeedForward::none);
  EXPECT_THAT(loaded.resolved_json, testing::Not(HasSubstr("\"controller\"")));
}

TEST(Control, StartsEmptyAsVersion1DidUnlessTheProblemSaysOtherwise) {
  const LoadedProblem plain = load_with_gains({});
  EXPECT_EQ(plain.tracking()->config().task.control_start, ControlStart::empty);
  const LoadedProblem empty = load_with_gains({"control.start=empty"});
  EXPECT_EQ(empty.resolved_json, plain.resolved_json) << "a record of version 1.0 lacks the key";
  const LoadedProblem held = load_with_gains({"control.start=gravity"});
  EXPECT_EQ(held.tracking()->config().task.control_start, ControlStart::gravity);
  EXPECT_THAT(held.resolved_json, HasSubstr("\"start\":\"gravity\""));
  EXPECT_THAT(usage_error_of([] { load_with_gains({"control.start=full"}); }),
              HasSubstr("unknown control.start 'full'"));
  EXPECT_EQ(load_problem("robot").tracking()->config().task.control_start, ControlStart::gravity);
}

class EveryControl : public testing::TestWithParam<std::string> {};

TEST_P(EveryControl, TakesTheStartOver) {
  const LoadedProblem plain = load_with_gains({});
  const LoadedProblem loaded = load_under(GetParam());
  const ControllerRow& row = find_controller(GetParam());
  const TrackingConfig& config = loaded.tracking()->config();
  EXPECT_EQ(config.start.controller, row.name);
  EXPECT_EQ(config.task.feed_forward, row.feed_forward);
  const std::size_t joints = config.robot.joint_count();
  const auto& variables = loaded.problem->description().variables;
  ASSERT_EQ(variables.size(), joints * (row.gains.size() + 2));
  for (std::size_t joint = 0; joint < joints; ++joint) {
    const JointDrive& before = plain.tracking()->config().start.joints[joint];
    EXPECT_EQ(config.start.joints[joint].limits.min, before.limits.min);
    EXPECT_EQ(config.start.joints[joint].limits.max, before.limits.max);
    for (std::size_t k = 0; k < row.gains.size(); ++k) {
      const DecisionVariable& variable = variables[joint * (row.gains.size() + 2) + k];
      const controllers::Gain& gain = row.gains[k];
      EXPECT_TRUE(variable.name.ends_with(std::string(".") + gain.name)) << variable.name;
      EXPECT_EQ(variable.unit, gain.unit);
      EXPECT_EQ(variable.start, config.start.joints[joint].gains[k]);
      EXPECT_EQ(variable.scale, gain.range > 0 ? Scale::linear : Scale::logarithmic);
      EXPECT_LE(variable.lower, variable.start);
      EXPECT_LT(variable.start, variable.upper);
      EXPECT_TRUE(gain.any_sign || variable.lower >= 0);
    }
  }
}

// A short simulated evaluation, through the problem: a number, and near that of the PID's start.
TEST_P(EveryControl, CanBeEvaluated) {
  const LoadedProblem loaded =
      load_under(GetParam(), {"physics.engine=articulated", "workspace.points=8"});
  std::vector<double> start;
  for (const DecisionVariable& variable : loaded.problem->description().variables) {
    start.push_back(variable.start);
  }
  const CaseBlock block{CaseRole::training, "train/1", {0, 1, 2}};
  const Evaluation evaluation = loaded.problem->evaluate(start, block, true);
  EXPECT_EQ(evaluation.status, EvaluationStatus::ok) << evaluation.reason;
  EXPECT_EQ(evaluation.jacobian.size(), evaluation.residuals.size() * start.size());
  ASSERT_FALSE(evaluation.metrics.empty());
  EXPECT_LT(evaluation.metrics[0], GetParam() == "fuzzy" ? 0.1 : 0.05);
}

TEST_P(EveryControl, DesignsSurviveTheirFile) {
  DesignFile file;
  file.name = "made";
  file.title = "a start";
  file.source = "converted";
  file.design = load_under(GetParam()).tracking()->config().start;
  file.design.joints[1].gains.back() *= 1.0 / 3;
  for (std::size_t k = 0; k < find_controller(GetParam()).gains.size(); ++k) {
    if (find_controller(GetParam()).gains[k].any_sign) {
      file.design.joints[2].gains[k] = -0.1 * static_cast<double>(k);
    }
  }
  file.joint_names = {"a", "b", "c", "d"};
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "made.toml").string();
  std::ofstream(path, std::ios::binary) << to_toml(file);
  const DesignFile read = load_design(path);
  EXPECT_EQ(read.design.controller, file.design.controller);
  ASSERT_EQ(read.design.joints.size(), file.design.joints.size());
  for (std::size_t joint = 0; joint < read.design.joints.size(); ++joint) {
    EXPECT_EQ(read.design.joints[joint].gains, file.design.joints[joint].gains);
  }
  // As a start it is used as it is, by its own controller or without naming it.
  const LoadedProblem again = load_under(GetParam(), {"variables.start=" + path});
  EXPECT_EQ(again.tracking()->config().start.joints[2].gains, file.design.joints[2].gains);
  std::vector<std::string> settings = list_settings_of(GetParam());
  settings.front() = "variables.start=" + path;
  const LoadedProblem unnamed = load_with_gains(settings);
  EXPECT_EQ(unnamed.tracking()->config().start.controller, GetParam());
  EXPECT_EQ(unnamed.tracking()->config().task.feed_forward,
            find_controller(GetParam()).feed_forward);
  if (GetParam() != "pid" && find_controller(GetParam()).interface == ControlInterface::effort) {
    EXPECT_THAT(usage_error_of([&] {
                  load_with_gains(
                      {"control.controller=" + std::string(GetParam() == "pi2d" ? "pid" : "pi2d"),
                       "variables.start=" + path});
                }),
                HasSubstr("the start design is for controller '" + GetParam() +
                          "'; only a design for 'pid' can be converted to"));
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryControl, testing::ValuesIn(controller_names()),
                         [](const auto& test) { return test.param; });

TEST(Control, RangesAreLinearAndStopAtZero) {
  const LoadedProblem filtered = load_with_gains({"control.controller=pid_filtered"});
  const DecisionVariable& b = get_variable(filtered, "joint_1.b");
  EXPECT_EQ(b.lower, 0);
  EXPECT_EQ(b.start, 1);
  EXPECT_EQ(b.upper, 2);
  const DecisionVariable& filter = get_variable(filtered, "joint_1.filter");
  EXPECT_EQ(filter.start, 0.001);
  EXPECT_EQ(filter.scale, Scale::logarithmic);
  const LoadedProblem neural = load_with_gains({"control.controller=neural"});
  const DecisionVariable& weight = get_variable(neural, "joint_3.w1_rate");
  EXPECT_EQ(weight.lower, -2);
  EXPECT_EQ(weight.start, 0);
  EXPECT_EQ(weight.upper, 2);
}

TEST(Control, GainsStandForAllOfAController) {
  EXPECT_EQ(load_with_gains({}).problem->description().variables.size(), 20U);
  EXPECT_THAT(
      usage_error_of([] {
        load_with_gains({"control.controller=cascade", R"(variables.optimize=["p"])"});
      }),
      HasSubstr("unknown design parameter 'p'; did you mean 'kp'? Valid: gains, kp, kv, ki, share, "
                "effort_min, effort_max"));
  EXPECT_THAT(usage_error_of([] { load_with_gains({R"(variables.optimize=["gains", "i"])"}); }),
              HasSubstr("'i' stands there twice"));
}

TEST(Control, TheFilterStartsAtATenthOfThePeriod) {
  const LoadedProblem loaded =
      load_with_gains({"control.controller=pid_filtered", "control.period_s=0.004"});
  EXPECT_EQ(loaded.tracking()->config().task.control_period_s, 0.004);
  EXPECT_DOUBLE_EQ(get_variable(loaded, "joint_1.filter").start, 0.0004);
}

TEST(Control, RefusesAStartThatMakesNoController) {
  const ProblemFolder folder;
  folder.write("d.toml",
               "name = 'd'\n" + make_joint() + make_joint() + make_joint() +
                   make_joint("p_n_m_per_rad = 300", "i_n_m_per_rad_s = 0", "d_n_m_s_per_rad = 0"));
  EXPECT_EQ(
      folder.refusal_of_base_with(
          "[control]\ncontroller = 'cascade'\n[variables]\nstart = 'd.toml'"),
      "p.toml:3: control.controller is 'cascade'; joint 4 of the start cannot be converted to "
      "'cascade': its PID has p = 300, i = 0, d = 0 and an effort limit of 200 N m, so "
      "kp_per_s would be inf; name another start");
}

TEST(Control, ADesignNeedsTheTablesOfItsController) {
  const LoadedProblem plain = load_with_gains({});
  const ArmDesign design =
      convert_design(plain.tracking()->config().start, "pid_computed_torque", 0.01);
  EXPECT_EQ(usage_error_of([&] { plain.tracking()->check_design(design); }),
            "the design is for controller 'pid_computed_torque', whose feed-forward efforts "
            "problem q2-e6 does not compute; set control.controller to 'pid_computed_torque'");
  load_with_gains({"control.controller=pid_computed_torque"}).tracking()->check_design(design);
  // Another controller without tables can be judged, but is no vector of this problem.
  const ArmDesign pi2d = convert_design(plain.tracking()->config().start, "pi2d", 0.01);
  plain.tracking()->check_design(pi2d);
  EXPECT_THAT(usage_error_of([&] { plain.tracking()->make_vector(pi2d); }),
              HasSubstr("the design is for controller 'pi2d', the variables of problem q2-e6 are "
                        "those of 'pid'"));
}

TEST(Control, AConvertedStartKeepsItsArmAndItsSpeed) {
  ArmDesign start = load_with_gains({}).tracking()->config().start;
  start.joints[1].length_scale = 1.1;
  start.joints[2].section_scale = 0.9;
  start.speed_m_per_s = 1.25;
  const ArmDesign converted = convert_design(start, "pi2d", 0.01);
  EXPECT_EQ(converted.joints[1].length_scale, 1.1);
  EXPECT_EQ(converted.joints[2].section_scale, 0.9);
  EXPECT_EQ(converted.speed_m_per_s, 1.25);
  EXPECT_EQ(converted.joints[3].limits.max, start.joints[3].limits.max);
}

// What runs recorded before the control period had a table of its own.
TEST(Control, RecordsOfOldRunsCanBeRead) {
  const LoadedProblem now = load_with_gains({"control.period_s=0.005"});
  std::string old = now.resolved_json;
  const std::string entry = "\"control\":{\"period_s\":0.005},";
  ASSERT_NE(old.find(entry), std::string::npos) << old;
  old.erase(old.find(entry), entry.size());
  const std::string task = "\"task\":{";
  old.insert(old.find(task) + task.size(), "\"control_period_s\":0.005,");
  const LoadedProblem again = load_recorded_problem(old, "q2-e6", ".");
  EXPECT_EQ(again.tracking()->config().task.control_period_s, 0.005);
  EXPECT_EQ(again.resolved_json, now.resolved_json);
}

}  // namespace
}  // namespace armwright
