// The tracking loop on arms that follow a script instead of physics. The timeline, the calls of the
// arm and the measures are compared with numbers computed by hand.
#include "sim/tracking/tracking_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

using testing::ElementsAre;

// Two moves of 0.3 m at 1.5 m/s: t_m = 0.2 s, then 0.5 s of rest, so 70 periods of 10 ms each, and
// the errors of the last 51 of them count (t = 0.20 ... 0.70 s).
const std::vector<Eigen::Vector3d> kPoints_m{{1.4, 0.1, 0.9}, {1.7, 0.1, 0.9}, {1.7, -0.2, 0.9}};
constexpr int kSteps = 70, kWindowStart = 19;

TrackingTask make_task(int substeps = 1) {
  TrackingTask task;
  task.signal = SignalShape::ramp;
  task.distance_limit_m = 0;
  task.physics.substeps = substeps;
  return task;
}

// An arm that keeps its joint positions. Its tip is at the position that the script gives for a
// count of steps.
struct ScriptedArm {
  std::vector<double> q_rad{0.1, 0.2, -0.3, 0.4};
  std::function<Eigen::Vector3d(int)> tip_m = [](int) { return Eigen::Vector3d(1, 2, 3); };
  int diverges_in_step = -1;

  std::vector<std::vector<double>> efforts_n_m;
  std::vector<double> steps_s;

  void step(std::span<const double> effort_n_m, double dt_s,
            std::span<const double> /*inertia*/ = {}) {
    if (static_cast<int>(steps_s.size()) == diverges_in_step) {
      throw DivergenceError("joint 2 (elbow): gone");
    }
    efforts_n_m.emplace_back(effort_n_m.begin(), effort_n_m.end());
    steps_s.push_back(dt_s);
  }
  void read_positions(std::span<double> q) const {
    std::copy(q_rad.begin(), q_rad.end(), q.begin());
  }
  void read_rates(std::span<double> qd) const { std::ranges::fill(qd, 0.0); }
  Eigen::Vector3d tip_position_m() const { return tip_m(static_cast<int>(steps_s.size())); }
  Eigen::Vector3d tool_point_m(std::size_t /*point*/) const { return tip_position_m(); }
};

// P only, no limit reached.
const ArmDesign kProportional = make_design(
    {{10, 0, 0, -1e3, 1e3}, {20, 0, 0, -1e3, 1e3}, {30, 0, 0, -1e3, 1e3}, {40, 0, 0, -1e3, 1e3}});

struct ScriptedRun {
  TrackingSetup setup;
  TargetTable targets = setup.make_targets({kPoints_m});
  TrackingJob job = make_job(kProportional, targets);

  explicit ScriptedRun(const TrackingTask& task) : setup(load_irb4600(), task) {}
  TrackingResult operator()(ScriptedArm& arm) { return TrackingLoop(setup, job).run(arm); }
};

TEST(TrackingLoop, StepsThePlantOnceAPeriodWithTheEffortForTheTargetAtItsEnd) {
  ScriptedRun run(make_task());
  ScriptedArm arm;
  const TrackingResult result = run(arm);
  EXPECT_EQ(result.status, SimulationStatus::ok);
  EXPECT_EQ(result.steps, 2 * kSteps);
  ASSERT_EQ(arm.steps_s.size(), static_cast<std::size_t>(2 * kSteps));
  const ElbowUpKinematics kinematics(run.setup.robot());
  for (int k = 0; k < 2 * kSteps; ++k) {
    EXPECT_EQ(arm.steps_s[static_cast<std::size_t>(k)], 0.01);
    const double share = std::min(1.0, (k % kSteps + 1) * 0.01 / 0.2);
    const Eigen::Vector3d &from = kPoints_m[k / kSteps], &to = kPoints_m[k / kSteps + 1];
    std::array<double, 4> target{};
    ASSERT_TRUE(kinematics.solve(from + share * (to - from), target));
    for (std::size_t i = 0; i < 4; ++i) {
      // Rounding of angles of size 1, times a gain of at most 40.
      EXPECT_NEAR(arm.efforts_n_m[static_cast<std::size_t>(k)][i],
                  10 * (static_cast<double>(i) + 1) * (target[i] - arm.q_rad[i]), 1e-12)
          << "step " << k << ", joint " << i + 1;
    }
  }
}

TEST(TrackingLoop, HoldsTheEffortOverSubsteps) {
  ScriptedRun run(make_task(4));
  ScriptedRun plain(make_task());
  run.job.design = plain.job.design = &kTableA1;  // its efforts depend on the control period
  ScriptedArm arm, plain_arm;
  EXPECT_EQ(run(arm).steps, 2 * kSteps);
  plain(plain_arm);
  ASSERT_EQ(arm.steps_s.size(), static_cast<std::size_t>(8 * kSteps));
  for (std::size_t k = 0; k < arm.steps_s.size(); ++k) {
    EXPECT_EQ(arm.steps_s[k], 0.0025);
    EXPECT_EQ(arm.efforts_n_m[k], plain_arm.efforts_n_m[k / 4]);
  }
}

// The error only shrinks, so the largest one in the window is its first one, at t = t_m.
TEST(TrackingLoop, MeasuresFromTheEndOfTheMove) {
  ScriptedRun run(make_task());
  ScriptedArm arm;
  arm.tip_m = [](int steps) {
    const int k = (steps - 1) % kSteps, segment = (steps - 1) / kSteps;
    return Eigen::Vector3d(kPoints_m[static_cast<std::size_t>(segment) + 1] +
                           Eigen::Vector3d(0, 0, 1.0 / (k + 1)));
  };
  run.job.recording.error_series = true;
  const TrackingResult result = run(arm);
  ASSERT_EQ(result.point_error_m.size(), 2u);
  for (const double error_m : result.point_error_m) {
    EXPECT_NEAR(error_m, 1.0 / (kWindowStart + 1), 1e-15);
  }
  EXPECT_EQ(result.error_series_m.size(), static_cast<std::size_t>(2 * kSteps));
  EXPECT_NEAR(result.mean_error_m, 1.0 / (kWindowStart + 1), 1e-15);  // of the second point alone
}

// An error in a single period: the last one that counts, or the one before the first that counts.
TEST(TrackingLoop, MeasuresToTheEndOfTheRest) {
  for (const int spike : {kWindowStart - 1, kWindowStart, kSteps - 1}) {
    ScriptedRun run(make_task());
    ScriptedArm arm;
    arm.tip_m = [&](int steps) {
      const double off_m = (steps - 1) % kSteps == spike ? 0.25 : 0.125;
      return Eigen::Vector3d(kPoints_m[static_cast<std::size_t>((steps - 1) / kSteps) + 1] +
                             Eigen::Vector3d(0, off_m, 0));
    };
    const double expected_m = spike < kWindowStart ? 0.125 : 0.25;
    EXPECT_THAT(run(arm).point_error_m, ElementsAre(testing::DoubleNear(expected_m, 1e-15),
                                                    testing::DoubleNear(expected_m, 1e-15)))
        << spike;
  }
}

// Errors of 0.25 m at the first point and 0.125 m at the second.
Eigen::Vector3d tip_off_by_quarter_then_eighth(int steps) {
  const bool first = steps <= kSteps;
  return kPoints_m[first ? 1 : 2] + Eigen::Vector3d(first ? 0.25 : 0.125, 0, 0);
}

TEST(TrackingLoop, CountsTheFirstPointOnRequest) {
  for (const bool count : {false, true}) {
    TrackingTask task = make_task();
    task.count_first_point = count;
    ScriptedRun run(task);
    ScriptedArm arm;
    arm.tip_m = tip_off_by_quarter_then_eighth;
    EXPECT_NEAR(run(arm).mean_error_m, count ? (0.25 + 0.125) / 2 : 0.125, 1e-15);
  }
}

TEST(TrackingLoop, CutsOffInThePeriodInWhichTheErrorIsTooLarge) {
  ScriptedRun run(make_task());
  run.job.cutoff_m = 0.3;
  ScriptedArm arm;
  arm.tip_m = [](int steps) {  // from period 30 of the second segment on
    const double off_m = steps > kSteps + 30 ? 0.4 : 0.2;
    return Eigen::Vector3d(kPoints_m[steps <= kSteps ? 1 : 2] + Eigen::Vector3d(off_m, 0, 0));
  };
  const TrackingResult result = run(arm);
  EXPECT_EQ(result.status, SimulationStatus::cut_off);
  EXPECT_EQ(result.reason, "cut off at point 2 (1.01 s): the error exceeds 0.3 m");
  EXPECT_EQ(result.steps, kSteps + 31);
  EXPECT_THAT(result.point_error_m, ElementsAre(testing::DoubleNear(0.2, 1e-15), 0.3));
  EXPECT_EQ(result.mean_error_m, 0.3);
}

// Before the window, the tip's position does not count.
TEST(TrackingLoop, DoesNotCutOffDuringAMove) {
  ScriptedRun run(make_task());
  run.job.cutoff_m = 0.3;
  ScriptedArm arm;
  arm.tip_m = [](int steps) {
    const double off_m = (steps - 1) % kSteps < kWindowStart ? 5 : 0.2;
    return Eigen::Vector3d(kPoints_m[steps <= kSteps ? 1 : 2] + Eigen::Vector3d(off_m, 0, 0));
  };
  EXPECT_EQ(run(arm).status, SimulationStatus::ok);
}

TEST(TrackingLoop, ADivergenceOnTheWayKeepsThePointsReached) {
  for (const bool cut_off : {false, true}) {
    ScriptedRun run(make_task());
    if (cut_off) {
      run.job.cutoff_m = 0.3;
    }
    ScriptedArm arm;
    arm.tip_m = tip_off_by_quarter_then_eighth;
    arm.diverges_in_step = kSteps + 12;
    const TrackingResult result = run(arm);
    EXPECT_EQ(result.status, SimulationStatus::diverged);
    EXPECT_EQ(result.reason, "diverged at 0.83 s, on the way to point 2: joint 2 (elbow): gone");
    EXPECT_EQ(result.steps, kSteps + 12);
    if (cut_off) {
      EXPECT_THAT(result.point_error_m, ElementsAre(testing::DoubleNear(0.25, 1e-15), 0.3));
      EXPECT_EQ(result.mean_error_m, 0.3);
    } else {
      EXPECT_THAT(result.point_error_m, ElementsAre(testing::DoubleNear(0.25, 1e-15)));
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
