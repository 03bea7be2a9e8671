// Arms with unactuated joints as problems: their targets, variables and simulations, and refusals.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "problems/load_tracking.hpp"
#include "problems/problem_folder.hpp"
#include "sim/engines/engine_table.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kFewPoints = {"workspace.points=3"};

TEST(UnactuatedJoint, HasNoVariablesAndNoTargets) {
  const LoadedProblem loaded = load_problem("subudhi-flexible", kFewPoints);
  const TrackingConfig& config = loaded.tracking()->config();
  std::size_t unactuated = 0;
  for (std::size_t i = 0; i < config.robot.joint_count(); ++i) {
    const Joint& joint = config.robot.joints[i];
    unactuated += joint.plant.unactuated ? 1 : 0;
    EXPECT_EQ(joint.plant.unactuated, joint.name.starts_with("bend_")) << joint.name;
    EXPECT_EQ(calc_largest_effort(config.start.joints[i]) == 0, joint.plant.unactuated);
  }
  EXPECT_EQ(unactuated, 4u);
  EXPECT_EQ(loaded.problem->description().variables.size(), 2u * 3);
  for (const DecisionVariable& variable : loaded.problem->description().variables) {
    EXPECT_FALSE(variable.name.starts_with("bend_")) << variable.name;
  }
  const TargetTable targets = loaded.tracking()->setup().make_targets(
      TestSet::make_generated("test/1", config.workspace).make_case(3));
  ASSERT_EQ(targets.unreachable, "");
  double moved = 0;
  for (int step = 0; step < targets.steps; ++step) {
    for (std::size_t i = 0; i < config.robot.joint_count(); ++i) {
      if (config.robot.joints[i].plant.unactuated) {
        ASSERT_EQ(targets.positions(step)[i], 0) << config.robot.joints[i].name;
      } else {
        moved = std::max(moved, std::abs(targets.positions(step)[i] - targets.start_positions[i]));
      }
    }
  }
  EXPECT_GT(moved, 0.1);
}

// The same case in every engine, and under every controller of efforts in lanes.
TEST(UnactuatedJoint, IsSimulatedInEveryEngine) {
  const LoadedProblem loaded = load_problem("subudhi-flexible", kFewPoints);
  const TrackingProblem& problem = *loaded.tracking();
  const TargetTable targets = problem.setup().make_targets(
      TestSet::make_generated("test/1", problem.config().workspace).make_case(1));
  TrackingJob job;
  job.design = &problem.config().start;
  job.targets = &targets;
  job.recording.motion = true;
  const TrackingResult expected =
      std::move(make_engine("articulated")->simulate(problem.setup(), {&job, 1}).at(0));
  ASSERT_EQ(expected.status, SimulationStatus::ok) << expected.reason;
  double most_bend_rad = 0;
  const std::size_t joints = problem.config().robot.joint_count();
  for (std::size_t k = 1; k < expected.joint_positions.size(); k += joints) {
    most_bend_rad = std::max(most_bend_rad, std::abs(expected.joint_positions[k]));
  }
  EXPECT_GT(most_bend_rad, 1e-3);
  for (std::size_t i = 0; i < joints; ++i) {
    if (problem.config().robot.joints[i].plant.unactuated) {
      EXPECT_EQ(expected.peak_effort[i], 0);
      EXPECT_EQ(expected.saturated_share[i], 0);
    }
  }
  for (const std::string& name : engine_names()) {
    SCOPED_TRACE(name);
    const TrackingResult result =
        std::move(make_engine(name)->simulate(problem.setup(), {&job, 1}).at(0));
    ASSERT_EQ(result.status, SimulationStatus::ok) << result.reason;
    ASSERT_EQ(result.tips_m.size(), expected.tips_m.size());
    EXPECT_NEAR(result.mean_error_m, expected.mean_error_m, 0.01 * expected.mean_error_m);
    if (name != "ode") {
      double gap_m = 0;
      for (std::size_t k = 0; k < result.tips_m.size(); ++k) {
        gap_m = std::max(gap_m, (result.tips_m[k] - expected.tips_m[k]).norm());
      }
      EXPECT_LT(gap_m, 1e-6);
    }
  }
}

TEST(UnactuatedJoint, LetsEveryControllerOfEffortsTuneTheMotors) {
  for (const ControllerRow& row : controller_table()) {
    if (row.interface != ControlInterface::effort) {
      continue;
    }
    SCOPED_TRACE(row.name);
    const LoadedProblem loaded = load_problem(
        "subudhi-flexible",
        std::vector<std::string>{"workspace.points=3", "control.controller=" + row.name});
    const Evaluation evaluation = loaded.problem->evaluate(
        get_start(*loaded.tracking()), CaseBlock{CaseRole::training, "train/1", {0}}, true);
    EXPECT_EQ(evaluation.status, EvaluationStatus::ok) << evaluation.reason;
    EXPECT_FALSE(evaluation.jacobian.empty());
    EXPECT_TRUE(
        std::ranges::all_of(evaluation.jacobian, [](double x) { return std::isfinite(x); }));
  }
}

std::string get_flexible_refusal(const std::vector<std::string>& overrides) {
  return usage_error_of([&] { load_problem("subudhi-flexible", overrides); });
}

TEST(UnactuatedJoint, RefusalsNameTheJoint) {
  EXPECT_THAT(get_flexible_refusal({"control.interface=velocity"}),
              HasSubstr("joint 'bend_1_1' is unactuated; drives with inner loops"));
  EXPECT_THAT(get_flexible_refusal({"task.home=[0, 0.1, 0, 0, 0, 0]"}),
              HasSubstr("joint 'bend_1_1' is unactuated; its position must be 0"));
  EXPECT_THAT(get_flexible_refusal({"physics.substeps=1", "control.period_s=0.05"}),
              HasSubstr("the spring of joint 'bend_"));
  const ProblemFolder folder;
  EXPECT_THAT(folder.refusal_of("extends = 'subudhi-flexible'\nname = 'p'\n[[variables.joint]]\n"
                                "name = 'bend_2_1'\noptimize = ['p']\n"),
              HasSubstr("name is 'bend_2_1'; that joint is unactuated"));
  const LoadedProblem loaded = load_problem("subudhi-flexible", kFewPoints);
  ArmDesign design = loaded.tracking()->config().start;
  design.joints[1].gains[0] = 1;
  EXPECT_THAT(usage_error_of([&] { loaded.tracking()->check_design(design); }),
              HasSubstr("joint 'bend_1_1' is unactuated, so it has no controller; the design must "
                        "have 0 for all its gains and both effort limits"));
}

TEST(UnactuatedJoint, ThePlantsFileIsChecked) {
  const ProblemFolder folder;
  std::filesystem::copy(std::filesystem::path(ARMWRIGHT_CONFIGS) / "robots/subudhi_flexible.urdf",
                        folder.path("arm.urdf"));
  const auto refusal = [&](const std::string& plant) {
    folder.write("arm.plant.toml", plant);
    folder.write("p.toml", "extends = 'robot'\nname = 'p'\n[robot]\nurdf = 'arm.urdf'\n");
    try {
      folder.load("p.toml");
    } catch (const Error& error) {
      return folder.shorten(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal("[joint.bend_1_1]\nunactuated = true\n"),
              HasSubstr("joint.bend_1_1.unactuated is true; such a joint needs "
                        "stiffness_n_m_per_rad > 0 or damping_n_m_s_per_rad > 0"));
  EXPECT_THAT(refusal("[joint.bend_1_1]\nunactuated = true\nstiffness_n_m_per_rad = -1\n"),
              HasSubstr("joint.bend_1_1.stiffness_n_m_per_rad is -1; it must be"));
  EXPECT_THAT(refusal("[joint.bend_1_1]\nunactuated = true\ndamping_n_m_s_per_rad = 1\n"
                      "measured = 'link'\n"),
              HasSubstr("joint.bend_1_1.measured is 'link'; the joint is unactuated"));
  std::string all;
  for (const char* name : {"shoulder", "bend_1_1", "bend_1_2", "elbow", "bend_2_1", "bend_2_2"}) {
    all += std::string("[joint.") + name + "]\nunactuated = true\nstiffness_n_m_per_rad = 3\n";
  }
  EXPECT_THAT(refusal(all), HasSubstr("all joints are unactuated ('shoulder' first)"));
}

}  // namespace
}  // namespace armwright
