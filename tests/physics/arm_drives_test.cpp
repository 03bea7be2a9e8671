// Drives with an inner loop: their response against closed forms and another integrator, their
// delay, limits and resolution, and engines against each other.
#include "sim/tracking/arm_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/tracking/tracking_loop.hpp"
#include "swinging_arms.hpp"

namespace armwright::physics_test {
namespace {

constexpr double kBandwidth_rad_per_s = 2 * kPi * 10;
constexpr double kInertia_kg_m2 = 2;

// One joint with a vertical axis and a given inertia: gravity does not act.
RobotModel make_turntable(double speed_limit = 100) {
  RobotModel robot;
  append_link(robot, "table", {0, 0, 0}, {0, 0, 1},
              {1, {0, 0, 0}, Vector3d(2, 2.5, kInertia_kg_m2).asDiagonal()});
  robot.joints[0].lower = -3;
  robot.joints[0].upper = 3;
  robot.joints[0].speed_limit = speed_limit;
  robot.joints[0].effort_limit = 1e6;
  robot.tip_pose.translation() = Vector3d(1, 0, 0);
  return robot;
}

struct DriveCase {
  ControlInterface interface = ControlInterface::velocity;
  double delay_s = 0;
  double resolution_rad = 0;
  int substeps = 50;
  RobotModel robot = make_turntable();
  EffortLimits limits = {-1e6, 1e6};
  std::vector<double> gains = {0, 0, 0, 1};  // of pid_velocity: the target's rate alone

  TrackingTask make_task() const {
    TrackingTask task;
    task.physics.substeps = substeps;
    task.count_first_point = true;
    task.drives.interface = interface;
    task.drives.bandwidth_rad_per_s = kBandwidth_rad_per_s;
    task.drives.delay_s = delay_s;
    task.drives.resolution_rad = resolution_rad;
    return task;
  }
};

// Returns the positions of the one joint at the end of each control period, and all measures.
TrackingResult run(const DriveCase& one, const std::vector<double>& setpoints,
                   const std::string& engine = "articulated") {
  const TrackingSetup setup(one.robot, one.make_task());
  TargetTable targets;
  targets.joints = 1;
  targets.steps = static_cast<int>(setpoints.size());
  targets.start_positions = {0};
  targets.joint_positions = setpoints;
  Segment segment;
  segment.steps = targets.steps;
  segment.window_start = targets.steps - 1;
  segment.from_m = segment.to_m = Vector3d::Zero();
  targets.segments = {segment};
  ArmDesign design;
  design.controller = one.interface == ControlInterface::velocity ? "pid_velocity" : "pid_position";
  design.joints = {{one.gains, one.limits}};
  const TrackingJob job = make_job(design, targets, kNever, {.motion = true});
  TrackingResult result = std::move(make_engine(engine)->simulate(setup, {&job, 1}).at(0));
  EXPECT_EQ(result.status, SimulationStatus::ok) << result.reason;
  return result;
}

// Setpoints that move at a constant rate from the second period on.
std::vector<double> make_ramp(double rate, int steps) {
  std::vector<double> setpoints = {0};
  for (int k = 1; k < steps; ++k) {
    setpoints.push_back(setpoints.back() + rate * 0.01);
  }
  return setpoints;
}

// With a = w / 2, the rate is V (1 - exp(-a t) (1 - a t)) after a step of the command to V, so the
// position is V (t - t exp(-a t)). Euler's method is wrong by about w h / 2 of the largest deviation
// from V t, which is V / (e a), and finally V h ahead, because positions follow from the new rates.
TEST(VelocityDrive, FollowsAStepAsItsBandwidthSays) {
  for (const int substeps : {50, 200}) {
    DriveCase one;
    one.substeps = substeps;
    const double a = kBandwidth_rad_per_s / 2;
    const double step_s = 0.01 / substeps;
    const double tolerance = kBandwidth_rad_per_s * step_s / 2 / (2.718 * a) * 1.2 + step_s;
    const TrackingResult result = run(one, make_ramp(1, 60));
    double largest = 0;
    for (int k = 1; k < 60; ++k) {
      const double t = 0.01 * k;  // the command begins with the second period
      const double lag = t - result.joint_positions[static_cast<std::size_t>(k)];
      EXPECT_NEAR(lag, t * std::exp(-a * t), tolerance) << k;
      largest = std::max(largest, lag);
    }
    EXPECT_GT(largest, 30 * tolerance);
  }
}

// Without gravity, nothing happens before the command arrives, and then the same to the last bit.
TEST(VelocityDrive, ADelayShiftsTheMotionExactly) {
  for (const ControlInterface interface :
       {ControlInterface::velocity, ControlInterface::position}) {
    DriveCase one;
    one.interface = interface;
    if (interface == ControlInterface::position) {
      one.gains = {0, 0, 0};
    }
    const std::vector<double> prompt = run(one, make_ramp(0.5, 40)).joint_positions;
    one.delay_s = 0.03;
    const std::vector<double> late = run(one, make_ramp(0.5, 40)).joint_positions;
    EXPECT_GT(prompt.back(), 0.1);
    EXPECT_EQ(std::vector<double>(late.begin() + 3, late.end()),
              std::vector<double>(prompt.begin(), prompt.end() - 3));
    // A part of a period is a number of substeps: the motion then lies between both.
    one.delay_s = 0.004;
    const std::vector<double> between = run(one, make_ramp(0.5, 40)).joint_positions;
    for (std::size_t k = 2; k < 40; ++k) {
      EXPECT_LT(between[k], prompt[k]) << k;
      EXPECT_GT(between[k], prompt[k - 1]) << k;
    }
  }
}

TEST(VelocityDrive, KeepsToTheSpeedLimitAndTheEffortLimits) {
  DriveCase one;
  one.robot = make_turntable(0.8);
  one.limits = {-3, 5};
  const TrackingResult result = run(one, make_ramp(2, 100));
  EXPECT_NEAR((result.joint_positions[99] - result.joint_positions[98]) / 0.01, 0.8, 1e-6);
  EXPECT_EQ(result.peak_effort[0], 5);
  // 0.8 rad/s takes 0.32 s under 5 N m, and the loop leaves its limit a little earlier.
  EXPECT_NEAR(result.saturated_share[0], 0.32, 0.02);
  EXPECT_NEAR(result.energy_j, 0.5 * kInertia_kg_m2 * 0.8 * 0.8, 0.02);
  EXPECT_LT(result.rms_effort[0], 5 * std::sqrt(0.36));
  EXPECT_GT(result.rms_effort[0], 5 * std::sqrt(0.28));
}

// The continuous loop of a position drive whose setpoint moves from 0 at a constant rate for the
// time `moving_s`, by the method of Runge and Kutta.
std::vector<double> integrate_position_drive(double rate, double moving_s, int periods) {
  const double w = kBandwidth_rad_per_s;
  std::array<double, 3> x = {0, 0, 0};  // position, rate, integral of the rate's error
  const auto calc_slopes = [&](double t, const std::array<double, 3>& at) {
    const double setpoint = rate * std::min(t, moving_s);
    const double error = w / 4 * (setpoint - at[0]) + (t < moving_s ? rate : 0) - at[1];
    return std::array<double, 3>{at[1], w * error + w * w / 4 * at[2], error};
  };
  std::vector<double> positions;
  constexpr int kSteps = 200;
  const double h = 0.01 / kSteps;
  for (int k = 0; k < periods * kSteps; ++k) {
    const double t = k * h + 1e-12;
    const auto move = [&](const std::array<double, 3>& along, double by) {
      return std::array<double, 3>{x[0] + by * along[0], x[1] + by * along[1],
                                   x[2] + by * along[2]};
    };
    const auto k1 = calc_slopes(t, x);
    const auto k2 = calc_slopes(t, move(k1, h / 2));
    const auto k3 = calc_slopes(t, move(k2, h / 2));
    const auto k4 = calc_slopes(t, move(k3, h));
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    if ((k + 1) % kSteps == 0) {
      positions.push_back(x[0]);
    }
  }
  return positions;
}

TEST(PositionDrive, FollowsItsContinuousLoop) {
  DriveCase one;
  one.interface = ControlInterface::position;
  one.gains = {0, 0, 0};
  one.substeps = 200;
  std::vector<double> setpoints;
  for (int k = 0; k < 100; ++k) {
    setpoints.push_back(0.01 * std::min(k + 1, 30));
  }
  const TrackingResult result = run(one, setpoints);
  const std::vector<double> expected = integrate_position_drive(1, 0.3, 100);
  double largest = 0;
  for (std::size_t k = 0; k < 100; ++k) {
    // Euler's error is w h / 2 of the largest lag, about 2 %.
    EXPECT_NEAR(result.joint_positions[k], expected[k], 3e-4) << k;
    largest = std::max(largest, setpoints[k] - expected[k]);
  }
  EXPECT_GT(largest, 0.005);
  // At rest the loop has no error; its slowest pole, -0.17 w, has faded by exp(-7.6).
  EXPECT_NEAR(result.joint_positions[99], 0.3, 0.01 * std::exp(-7.6));
  EXPECT_NEAR(result.joint_positions[29], 0.3, 1e-3);  // and hardly any while it moves steadily
}

// A controller that sees its target within half a step of the resolution moves on until the measured
// position changes.
TEST(VelocityDrive, ControllersSeeTheResolution) {
  DriveCase one;
  one.gains = {5, 0, 0, 0};
  const std::vector<double> setpoints(300, 0.02);
  EXPECT_NEAR(run(one, setpoints).joint_positions.back(), 0.02, 1e-4);
  one.resolution_rad = 0.05;
  EXPECT_NEAR(run(one, setpoints).joint_positions.back(), 0.025, 0.004);
}

// Drives hold an arm from the start: its links do not fall at all while nothing moves.
TEST(ArmDrives, HoldTheArmFromTheStart) {
  RobotModel robot = load_irb4600();
  TrackingTask task = make_e6_task();
  task.physics.substeps = 10;
  task.drives = make_drives(ControlInterface::velocity);
  const TrackingSetup setup(robot, task);
  TargetTable targets = setup.make_targets(make_case(3, 4));
  for (int step = 0; step < targets.steps; ++step) {
    std::copy(targets.start_positions.begin(), targets.start_positions.end(),
              targets.joint_positions.begin() + 4 * step);
  }
  const ArmDesign design = convert_design(kTableA1, "pid_velocity", 0.01, task.drives.calc_lag_s());
  const TrackingJob job = make_job(design, targets, kNever, {.motion = true});
  for (const std::string& engine : engine_names()) {
    const TrackingResult result = std::move(make_engine(engine)->simulate(setup, {&job, 1}).at(0));
    EXPECT_GT(result.peak_effort[1], 100) << engine;
    for (const Vector3d& tip_m : result.tips_m) {
      ASSERT_LT((tip_m - result.tips_m.front()).norm(), 1e-7) << engine;
    }
  }
}

TEST(ArmDrives, AreRefusedToControllersOfAnotherInterface) {
  TrackingTask task = make_e6_task();
  task.physics.substeps = 10;
  const RobotModel robot = load_irb4600();
  const TrackingSetup plain(robot, task);
  task.drives = make_drives(ControlInterface::position);
  const TrackingSetup driven(robot, task);
  const TargetTable targets = plain.make_targets(make_case(3, 4));
  const ArmDesign moving = convert_design(kTableA1, "pid_velocity", 0.01);
  const TrackingJob jobs[] = {make_job(moving, targets), make_job(kTableA1, targets)};
  for (const std::string& engine : engine_names()) {
    EXPECT_THAT(usage_error_of([&] {
                  make_engine(engine)->simulate(plain, {&jobs[0], 1});
                }),
                testing::HasSubstr("controller 'pid_velocity' needs control.interface = "
                                   "\"velocity\", and it is \"effort\""));
    EXPECT_THAT(usage_error_of([&] {
                  make_engine(engine)->simulate(driven, {&jobs[1], 1});
                }),
                testing::HasSubstr("it is \"position\", whose controllers are pid_position"));
  }
}

// Whole arms of 3, 4, 6 and 7 joints with all parts of a plant, a perturbation and both interfaces:
// SIMD levels agree to rounding, articulated and MuJoCo to 1e-6 m, ODE to the size of its step.
TEST(DrivesInEngines, Agree) {
  const auto load = [](const std::string& name) {
    return load_urdf(ARMWRIGHT_CONFIGS "/robots/" + name + ".urdf");
  };
  for (const RobotModel& ideal : {load("arm7"), load("irb4600_six"), make_mixed_arm("rpr")}) {
    const TargetTable targets = make_swing(ideal, 120);
    for (const bool has_plant : {false, true}) {
      RobotModel robot = has_plant ? make_plant_of_size(ideal, targets).first : ideal;
      for (Joint& joint : robot.joints) {
        joint.speed_limit = 2;
      }
      PlantVariation variation;
      variation.viscous_friction.assign(robot.joint_count(), 1e-3);
      variation.coulomb_friction.assign(robot.joint_count(), 1e-3);
      variation.torque_ripple.assign(robot.joint_count(), 0.02);
      variation.ripple_phase_rad.assign(robot.joint_count(), 0.3);
      variation.delay_substeps = 4;
      for (const ControlInterface interface :
           {ControlInterface::velocity, ControlInterface::position}) {
        SCOPED_TRACE(testing::Message()
                     << robot.joint_count() << " joints, plant: " << has_plant << ", "
                     << control_interface_names()[static_cast<std::size_t>(interface)]);
        TrackingTask task;
        task.physics.substeps = 20;
        task.count_first_point = true;
        task.drives = make_drives(interface);
        const TrackingSetup setup(robot, task);
        ArmDesign design;
        design.joints.assign(robot.joint_count(), {{1, 1, 1}, {-3000, 3000}});
        design = convert_design(
            design, interface == ControlInterface::velocity ? "pid_velocity" : "pid_position", 0.01,
            task.drives.calc_lag_s());
        TrackingJob job = make_job(design, targets, kNever, {.motion = true});
        job.variation = has_plant ? &variation : nullptr;
        const auto simulate = [&](const std::string& engine, const EngineOptions& options = {}) {
          auto result = std::move(make_engine(engine, options)->simulate(setup, {&job, 1}).at(0));
          EXPECT_EQ(result.status, SimulationStatus::ok) << engine << ": " << result.reason;
          return result;
        };
        const TrackingResult expected = simulate("articulated", {.simd = SimdLevel::scalar});
        const auto compare = [&](const TrackingResult& other, double tolerance_m, double share) {
          EXPECT_LT(calc_largest_gap_m(other, expected), tolerance_m);
          EXPECT_NEAR(other.energy_j / expected.energy_j, 1, share);
          for (std::size_t i = 0; i < robot.joint_count(); ++i) {
            EXPECT_NEAR(other.rms_effort[i] / expected.rms_effort[i], 1, share) << i;
          }
        };
        for (const std::string& level : supported_simd_names()) {
          SCOPED_TRACE(level);
          compare(simulate("articulated", {.simd = parse_simd(level)}), 1e-9, 1e-6);
          compare(
              simulate("articulated", {.precision = Precision::single, .simd = parse_simd(level)}),
              1e-3, 1e-2);
        }
        ArticulatedArm arm(robot, targets.start_positions, task.physics);
        compare(TrackingLoop(setup, job).run(arm), 1e-9, 1e-6);
#ifdef ARMWRIGHT_WITH_MUJOCO
        compare(simulate("mujoco"), 1e-6, 1e-4);
#endif
        compare(simulate("ode"), 1e-2, 0.05);
      }
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
