// Whole simulations under every controller: engines agree, lanes do not affect each other, and
// feed-forward moves an arm that equals its model exactly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/tracking/design.hpp"
#include "sim/tracking/tracking_loop.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

class UnderController : public testing::TestWithParam<std::string> {
 protected:
  static TrackingTask make_task() { return make_e6_task(find_controller(GetParam())); }
  static ArmDesign convert(const ArmDesign& design, const std::string& controller) {
    return convert_design(design, controller, 0.01, make_task().drives.calc_lag_s());
  }
  static bool commands_drives() {
    return find_controller(GetParam()).interface != ControlInterface::effort;
  }
  static std::vector<TrackingResult> simulate(const std::string& engine, const TrackingSetup& setup,
                                              const std::vector<TrackingJob>& jobs) {
    return make_engine(engine)->simulate(setup, jobs);
  }
  TrackingSetup setup_{load_irb4600(), make_task()};
  ArmDesign design_ = convert(kTableA1, GetParam());
};

// Compares maximal coordinates with corrected joints and joint coordinates. Tolerance: a percent,
// as for the published designs, and 50 um, because feed-forward efforts do not fit ODE's plant
// exactly.
TEST_P(UnderController, EnginesAgree) {
  std::vector<TargetTable> targets;
  std::vector<TrackingJob> jobs;
  for (const int number : {1, 2, 3}) {
    targets.push_back(setup_.make_targets(make_case(static_cast<std::uint64_t>(number), 12)));
  }
  for (const TargetTable& table : targets) {
    jobs.push_back(make_job(design_, table));
  }
  const auto articulated = simulate("articulated", setup_, jobs);
  for (const std::string& engine : engine_names()) {
    const auto other = simulate(engine, setup_, jobs);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      ASSERT_EQ(other[i].status, SimulationStatus::ok) << engine << ": " << other[i].reason;
      EXPECT_NEAR(other[i].mean_error_m, articulated[i].mean_error_m,
                  0.01 * articulated[i].mean_error_m + 5e-5)
          << engine;
      EXPECT_LT(other[i].mean_error_m, 0.1) << engine;
    }
  }
}

// Compares the engine's single lane with a loop around one arm: the same equations in another
// order.
TEST_P(UnderController, LanesAgreeWithALoop) {
  const TargetTable targets = setup_.make_targets(make_case(4, 8));
  const TrackingJob job = make_job(design_, targets);
  ArticulatedArm arm(setup_.robot(), targets.start_positions, setup_.task().physics);
  const TrackingResult alone = TrackingLoop(setup_, job).run(arm);
  for (const std::string& level : supported_simd_names()) {
    const TrackingResult lane = make_engine("articulated", {.simd = parse_simd(level)})
                                    ->simulate(setup_, {&job, 1})
                                    .front();
    for (std::size_t k = 0; k < alone.point_error_m.size(); ++k) {
      EXPECT_NEAR(lane.point_error_m[k], alone.point_error_m[k], 1e-9) << level;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(lane.rms_effort[i] / alone.rms_effort[i], 1, 1e-6) << level;
      EXPECT_NEAR(lane.saturated_share[i], alone.saturated_share[i], 1e-3) << level;
    }
  }
}

// The other lanes do not change a job's result, even if they have other controllers, gains and
// cases, are cut off or diverge.
TEST_P(UnderController, NeighboursDoNotMatter) {
  TrackingTask task = make_task();
  task.feed_forward = FeedForward::inverse_dynamics;  // some controllers do not use it
  if (find_controller(GetParam()).feed_forward == FeedForward::gravity) {
    task.feed_forward = FeedForward::gravity;
  }
  const TrackingSetup setup(load_irb4600(), task);
  std::vector<TargetTable> targets;
  for (std::uint64_t number = 0; number < 5; ++number) {
    targets.push_back(setup.make_targets(make_case(number, 6)));
  }
  const ArmDesign limp = convert(kLimp, GetParam());
  ArmDesign others[] = {kTableA1, convert(kTableA1, "pi2d"), limp, kExploding, design_};
  if (commands_drives()) {  // all controllers of a task command the same
    others[0] = convert(kTableA5, GetParam());
    others[1] = convert(kTableA10, GetParam());
    others[3] = convert(kExploding, GetParam());
    others[3].joints[3].gains[0] = 1e8;
  }
  std::vector<TrackingJob> jobs;
  for (std::size_t i = 0; i < 60; ++i) {
    jobs.push_back(
        make_job(i % 3 == 0 ? design_ : others[i % 5], targets[i % 5], i % 2 == 0 ? 0.3 : kNever));
  }
  const auto engine = make_engine("articulated");
  const auto together = engine->simulate(setup, jobs);
  for (std::size_t i = 0; i < jobs.size(); i += 3) {
    expect_identical(together[i], engine->simulate(setup, {&jobs[i], 1}).front());
  }
}

// Returns how far the tip of an arm whose target stands still moves within a second, with controllers
// that start as the task says.
double calc_sag_m(const PhysicsEngine& engine, TrackingTask task, ControlStart start,
                  const ArmDesign& design) {
  task.control_start = start;
  const TrackingSetup setup(load_irb4600(), task);
  TargetTable targets = setup.make_targets(make_case(5, 3));
  for (std::size_t i = 0; i < targets.joint_positions.size(); ++i) {
    targets.joint_positions[i] = targets.start_positions[i % targets.joints];
  }
  if (task.feed_forward != FeedForward::none) {
    for (std::size_t i = 0; i < targets.feed_forward_effort.size(); ++i) {
      targets.feed_forward_effort[i] = targets.feed_forward_effort[i % targets.joints];
    }
  }
  const TrackingJob job = make_job(design, targets, kNever, {.motion = true});
  const TrackingResult result = engine.simulate(setup, {&job, 1}).front();
  EXPECT_EQ(result.status, SimulationStatus::ok) << result.reason;
  const Eigen::Vector3d start_m = targets.segments.front().from_m;
  double farthest_m = 0;
  for (std::size_t k = 0; k < 100; ++k) {
    farthest_m = std::max(farthest_m, (result.tips_m.at(k) - start_m).norm());
  }
  return farthest_m;
}

// The integral holds all of the effort, or what a share of it leaves. ODE's joints give by about
// 1e-7 m, and single precision has 7 digits of a 3 m long arm; the rest is rounding.
TEST_P(UnderController, HoldsTheArmFromTheFirstPeriodOn) {
  TrackingTask task = make_task();
  if (task.feed_forward == FeedForward::inverse_dynamics) {
    task.feed_forward = FeedForward::gravity;  // the same while nothing moves
  }
  ArmDesign design = design_;
  const auto gains = find_controller(GetParam()).gains;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    for (JointDrive& joint : design.joints) {
      joint.gains[k] = std::string_view(gains[k].name) == "share" ? 0.6 : joint.gains[k];
    }
  }
  const bool has_hold = GetParam() != "neural" && GetParam() != "fuzzy";
  for (const std::string& name : engine_names()) {
    const auto engine = make_engine(name);
    const double sag_m = calc_sag_m(*engine, task, ControlStart::empty, design);
    if (find_controller(GetParam()).interface == ControlInterface::effort) {
      EXPECT_GT(sag_m, 1e-3) << name;  // drives with an inner loop hold the arm themselves
    }
    const double held_m = calc_sag_m(*engine, task, ControlStart::gravity, design);
    if (has_hold) {
      EXPECT_LT(held_m, 1e-6) << name;
    } else {
      EXPECT_EQ(held_m, sag_m) << name;
    }
  }
  const auto single = make_engine("articulated", {.precision = Precision::single, .simd = {}});
  if (has_hold) {
    EXPECT_LT(calc_sag_m(*single, task, ControlStart::gravity, design), 1e-5);
  }
}

// Elsewhere the arm is simulated as with empty integrals, and lanes agree with a loop.
TEST_P(UnderController, LanesHoldTheArmAsALoopDoes) {
  TrackingTask task = make_task();
  task.control_start = ControlStart::gravity;
  const TrackingSetup setup(load_irb4600(), task);
  const TargetTable targets = setup.make_targets(make_case(4, 8));
  const TrackingJob job = make_job(design_, targets);
  ArticulatedArm arm(setup.robot(), targets.start_positions, setup.task().physics);
  const TrackingResult alone = TrackingLoop(setup, job).run(arm);
  for (const std::string& level : supported_simd_names()) {
    const TrackingResult lane =
        make_engine("articulated", {.simd = parse_simd(level)})->simulate(setup, {&job, 1}).front();
    for (std::size_t k = 0; k < alone.point_error_m.size(); ++k) {
      EXPECT_NEAR(lane.point_error_m[k], alone.point_error_m[k], 1e-9) << level;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, UnderController, testing::ValuesIn(controller_names()),
                         [](const auto& test) { return test.param; });

// Without rules it is the PID: with the arithmetic of all laws (pi2d without its second integral) in every
// engine, and with that of the plain PID where lanes fuse no operations.
TEST(FuzzyReference, WithoutRulesIsThePidBitByBit) {
  const TrackingSetup setup(load_irb4600(), make_e6_task());
  const TargetTable targets = setup.make_targets(make_case(2, 12));
  const ArmDesign design = convert_design(kTableA1, "fuzzy_reference", 0.01);
  ArmDesign pid = convert_design(kTableA1, "pi2d", 0.01);
  for (JointDrive& joint : pid.joints) {
    joint.gains[2] = 0;
  }
  const auto expect_same = [&](const PhysicsEngine& engine, const ArmDesign& other) {
    const TrackingJob jobs[] = {make_job(design, targets), make_job(other, targets)};
    const auto results = engine.simulate(setup, jobs);
    ASSERT_EQ(results[0].status, SimulationStatus::ok) << results[0].reason;
    expect_identical(results[0], results[1]);
  };
  for (const std::string& name : engine_names()) {
    SCOPED_TRACE(name);
    expect_same(*make_engine(name), pid);
  }
  expect_same(*make_engine("articulated", {.simd = SimdLevel::scalar}), kTableA1);
}

// An integral that its limits or its gain do not allow is as large as they allow.
TEST(HoldingEffort, IsClampedAndNeedsAGain) {
  const ControllerRow& row = find_controller("pid");
  double states[2] = {7, 7};
  const auto hold = [&](double effort, double gain) {
    row.hold(effort, {-30, 20}, std::vector<double>{100, gain, 1}, states);
    EXPECT_EQ(states[1], 0);
    return states[0];
  };
  EXPECT_EQ(hold(10, 4), 2.5);
  EXPECT_EQ(hold(50, 4), 5);
  EXPECT_EQ(hold(-50, 4), -7.5);
  EXPECT_EQ(hold(10, 0), 0);
  const ControllerRow& second = find_controller("pi2d");
  double three[3];
  second.hold(10, {-30, 20}, std::vector<double>{100, 4, 5, 1}, three);
  EXPECT_THAT(three, testing::ElementsAre(0, 0, 2));
  second.hold(10, {-30, 20}, std::vector<double>{100, 4, 0, 1}, three);
  EXPECT_THAT(three, testing::ElementsAre(2.5, 0, 0));
}

TEST(HoldingEffort, IsThatOfGravityAtTheStart) {
  TrackingTask task = make_e6_task();
  task.load_kg = 12;
  task.feed_forward = FeedForward::gravity;
  task.control_start = ControlStart::gravity;
  const TrackingSetup setup(load_irb4600(), task);
  const TargetTable targets = setup.make_targets(make_case(3, 4));
  EXPECT_THAT(targets.holding_effort, testing::ElementsAreArray(targets.feed_forward(0)));
  EXPECT_GT(std::abs(targets.holding_effort[1]), 100);
  task.control_start = ControlStart::empty;
  const TargetTable empty = TrackingSetup(load_irb4600(), task).make_targets(make_case(3, 4));
  EXPECT_TRUE(empty.holding_effort.empty());
  EXPECT_EQ(empty.feed_forward_effort, targets.feed_forward_effort);
}

// Without any feedback and with one step per period, the model's efforts take the model exactly to
// its targets. On an arm without feedback, rounding errors grow by a few powers of ten over some
// hundred steps.
TEST(FeedForwardTable, TakesTheModelToItsTargets) {
  TrackingTask task = make_e6_task();
  task.feed_forward = FeedForward::inverse_dynamics;
  const TrackingSetup setup(load_irb4600(), task);
  const TargetTable targets = setup.make_targets(make_case(3, 4));
  ASSERT_EQ(targets.feed_forward_effort.size(), targets.joint_positions.size());
  ArticulatedArm arm(setup.robot(), targets.start_positions, task.physics);
  std::vector<double> q(4);
  double moved = 0;
  for (int step = 0; step < targets.steps; ++step) {
    arm.step(targets.feed_forward(step), task.control_period_s);
    arm.read_positions(q);
    for (std::size_t i = 0; i < 4; ++i) {
      ASSERT_NEAR(calc_displacement(JointKind::revolute, targets.positions(step)[i], q[i]), 0, 1e-7)
          << "step " << step;
      moved = std::max(moved, std::abs(q[i] - targets.start_positions[i]));
    }
  }
  EXPECT_GT(moved, 0.3);
}

TEST(FeedForwardTable, HoldsTheModelWhereItsTargetIs) {
  TrackingTask task = make_e6_task();
  task.feed_forward = FeedForward::gravity;
  const TrackingSetup setup(load_irb4600(), task);
  const TargetTable targets = setup.make_targets(make_case(3, 4));
  // The posture before step k is the target at the end of step k - 1.
  for (const int step : {0, 20, 60, 130}) {
    const auto posture =
        step == 0 ? std::span<const double>(targets.start_positions) : targets.positions(step - 1);
    ArticulatedArm arm(setup.robot(), posture, task.physics);
    const Eigen::VectorXd bias = arm.calc_bias();
    arm.step(targets.feed_forward(step), 0.01);
    std::vector<double> rates(4);
    arm.read_rates(rates);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(rates[i], 0, 1e-12);
      EXPECT_NEAR(targets.feed_forward(step)[i], bias[static_cast<Eigen::Index>(i)], 1e-9);
    }
  }
  EXPECT_GT(std::abs(targets.feed_forward(0)[1]), 100);
}

TEST(FeedForwardTable, IsThereOnlyWhereItIsAskedForAndCounted) {
  const TrackingSetup without(load_irb4600(), make_e6_task());
  TrackingTask task = make_e6_task();
  task.feed_forward = FeedForward::gravity;
  const TrackingSetup with(load_irb4600(), task);
  const TargetTable plain = without.make_targets(make_case(3, 4));
  const TargetTable full = with.make_targets(make_case(3, 4));
  EXPECT_TRUE(plain.feed_forward_effort.empty());
  EXPECT_EQ(plain.joint_positions, full.joint_positions);
  EXPECT_EQ(full.size_bytes(), plain.size_bytes() + full.joint_positions.size() * sizeof(double));
  const ArmDesign design = convert_design(kTableA1, "pid_gravity", 0.01);
  const TrackingJob job = make_job(design, plain);
  for (const std::string& engine : engine_names()) {
    EXPECT_THAT(usage_error_of([&] {
                  make_engine(engine)->simulate(without, {&job, 1});
                }),
                testing::HasSubstr("controller 'pid_gravity' needs feed-forward efforts"));
  }
}

}  // namespace
}  // namespace armwright::physics_test
