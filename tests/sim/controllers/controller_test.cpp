#include "sim/controllers/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

// An error of angles of size 1 is rounded to 2^-53; the gains below magnify that at most by P + I h
// + 2 D / h = 145.
constexpr double kPidTolerance = 1e-12;

struct PidStep {
  double setpoint_rad, measurement_rad;
  double effort_n_m;
  bool saturated;
};

// P = 100 N m/rad, I = 50 N m/(rad s), D = 2 N m s/rad, h = 0.1 s, -30 to 40 N m; u = 100 e + 50 S
// + 2 (e - e') / 0.1.
const std::vector<PidStep> kByHand = {
    {0.5, 0.30, 21.0, false},   // e  0.20, S 0.020, rate  0.0: 20 + 1.00 + 0
    {0.5, 0.25, 28.25, false},  // e  0.25, S 0.045, rate  0.5: 25 + 2.25 + 1
    {0.6, 0.20, 40.0, true},    // e  0.40, S 0.085, rate  1.5: 40 + 4.25 + 3 = 47.25
    {0.6, 0.30, 32.25, false},  // e  0.30, S 0.085 kept, rate -1: 30 + 4.25 - 2
    {0.6, 0.50, 10.75, false},  // e  0.10, S 0.095, rate -2.0: 10 + 4.75 - 4
    {0.2, 0.50, -30.0, true},   // e -0.30, S 0.065, rate -4.0: -30 + 3.25 - 8 = -34.75
    {0.2, 0.55, -30.0, true},   // e -0.35, S 0.065 kept, rate -0.5: -35 + 3.25 - 1 = -32.75
    {0.2, 0.30, -1.75, false},  // e -0.10, S 0.065 kept, rate 2.5: -10 + 3.25 + 5
    {0.2, 0.30, -7.25, false},  // e -0.10, S 0.055, rate  0.0: -10 + 2.75
};

TEST(PidController, FollowsASequenceComputedByHand) {
  const auto pid = make_pid(100, 50, 2, {-30, 40});
  EXPECT_FALSE(pid->saturated());
  for (std::size_t i = 0; i < kByHand.size(); ++i) {
    const PidStep& step = kByHand[i];
    EXPECT_NEAR(pid->step(step.setpoint_rad, step.measurement_rad, 0.1), step.effort_n_m,
                kPidTolerance)
        << "step " << i;
    EXPECT_EQ(pid->saturated(), step.saturated) << "step " << i;
  }
}

// Every number below is exact in binary. P = 4, I = 4, D = 0, h = 0.5 s, -3 to 3 N m.
TEST(PidController, AnEffortExactlyAtTheLimitIsNotClamped) {
  for (const double sign : {1.0, -1.0}) {
    const auto pid = make_pid(4, 4, 0, {-3, 3});
    EXPECT_EQ(pid->step(sign * 0.5, 0, 0.5), sign * 3);  // 2 + 4 x 0.25
    EXPECT_FALSE(pid->saturated());
    EXPECT_EQ(pid->step(sign * 0.5, 0, 0.5), sign * 3);  // integrates: 2 + 4 x 0.5 = 4
    EXPECT_TRUE(pid->saturated());
    EXPECT_EQ(pid->step(sign * 0.125, 0, 0.5), sign * 2.5);  // does not: 0.5 + 4 x 0.5
    EXPECT_FALSE(pid->saturated());
    EXPECT_EQ(pid->step(sign * 0.125, 0, 0.5), sign * 2.75);  // does again: 0.5 + 4 x 0.5625
  }
}

// Anti-windup: after a long saturation the controller has the same integral as before it.
TEST(PidController, DoesNotWindUp) {
  const auto pid = make_pid(4, 4, 0, {-3, 3});
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(pid->step(2, 0, 0.5), 3);  // S = 1 from the first step
  }
  EXPECT_EQ(pid->step(-0.5, 0, 0.5), 2);  // -2 + 4 x 1
  EXPECT_FALSE(pid->saturated());
}

TEST(PidController, TheFirstStepHasNoDerivative) {
  const auto pid = make_pid(0, 0, 8, {-100, 100});
  EXPECT_EQ(pid->step(0.75, 0.25, 0.125), 0);
  EXPECT_EQ(pid->step(1.25, 0.25, 0.125), 32);   // 8 x (1 - 0.5) / 0.125
  EXPECT_EQ(pid->step(0.25, 0.25, 0.125), -64);  // 8 x (0 - 1) / 0.125
}

TEST(PidController, TurnsTheShortWayRound) {
  const auto pid = make_pid(10, 0, 0, {-100, 100});
  EXPECT_NEAR(pid->step(3.1, -3.1, 0.01), 10 * (6.2 - 2 * kPi), kPidTolerance);
  EXPECT_NEAR(pid->step(-3.1, 3.1, 0.01), 10 * (2 * kPi - 6.2), kPidTolerance);
  EXPECT_NEAR(pid->step(kPi - 0.01, 0, 0.01), 10 * (kPi - 0.01), kPidTolerance);
  EXPECT_NEAR(pid->step(kPi + 0.01, 0, 0.01), 10 * (0.01 - kPi), kPidTolerance);
  EXPECT_NEAR(pid->step(0.5, 0.2 + 6 * kPi, 0.01), 10 * 0.3, kPidTolerance);
}

// Positions in metres are not wrapped. Every number is exact in binary.
TEST(PidController, GoesTheWholeWayOfAPrismaticJoint) {
  const auto pid = make_pid(8, 4, 2, {-1000, 1000}, JointKind::prismatic);
  EXPECT_EQ(pid->step(4, -4, 0.5), 80);     // e 8, S 4: 64 + 16 + 0
  EXPECT_EQ(pid->step(-4, 4, 0.5), -128);   // e -8, S 0, rate -32: -64 + 0 - 64
  EXPECT_EQ(pid->step(100, 0, 0.5), 1000);  // e 100, S 50, rate 216: 800 + 200 + 432
  EXPECT_TRUE(pid->saturated());
}

// The target moves from 3.13 past pi to -3.13, and the arm follows: the derivative must not jump by
// 2 pi / h.
TEST(PidController, TheDerivativeDoesNotSeeTheWrap) {
  const auto pid = make_pid(0, 0, 1, {-1000, 1000});
  pid->step(3.13, 3.10, 0.01);
  EXPECT_NEAR(pid->step(3.13 + 0.04 - 2 * kPi, 3.12, 0.01), 2,
              kPidTolerance);  // (0.05 - 0.03) / 0.01
}

TEST(PidController, ResetForgetsEverything) {
  const auto pid = make_pid(100, 50, 2, {-30, 40});
  pid->step(0.9, 0.1, 0.1);
  pid->step(2.9, 0.1, 0.1);
  ASSERT_TRUE(pid->saturated());
  pid->reset();
  EXPECT_FALSE(pid->saturated());
  const auto fresh = make_pid(100, 50, 2, {-30, 40});
  for (const PidStep& step : kByHand) {
    EXPECT_EQ(pid->step(step.setpoint_rad, step.measurement_rad, 0.1),
              fresh->step(step.setpoint_rad, step.measurement_rad, 0.1));
  }
}

TEST(PidController, AcceptsASingleEffort) {
  const auto pid = make_pid(100, 0, 0, {0, 0});
  EXPECT_EQ(pid->step(1, 0, 0.01), 0);
  EXPECT_TRUE(pid->saturated());
}

TEST(PidController, RefusesWhatCannotWork) {
  const auto refusal = [](double p, double i, double d, EffortLimits limits) {
    return usage_message([=] { make_pid(p, i, d, limits); });
  };
  EXPECT_EQ(refusal(kNan, 1, 1, {-1, 1}),
            "controller 'pid': p_n_m_per_rad is nan; it must be finite");
  EXPECT_EQ(refusal(1, kInfinity, 1, {-1, 1}),
            "controller 'pid': i_n_m_per_rad_s is inf; it must be finite");
  EXPECT_EQ(refusal(1, 1, -kInfinity, {-1, 1}),
            "controller 'pid': d_n_m_s_per_rad is -inf; it must be finite");
  EXPECT_EQ(
      refusal(1, 1, 1, {2, -3}),
      "controller 'pid': the effort limits are 2 to -3 N m; the lower must not exceed the upper");
  EXPECT_EQ(
      usage_message([] {
        make_pid(1, 1, 1, {2, -3}, JointKind::prismatic);
      }),
      "controller 'pid': the effort limits are 2 to -3 N; the lower must not exceed the upper");
  EXPECT_THAT(refusal(1, 1, 1, {kNan, 3}),
              testing::HasSubstr("the effort limits are nan to 3 N m"));
}

TEST(ControllerTable, HasThePidWithItsGains) {
  EXPECT_EQ(controller_names().front(), "pid");
  const ControllerRow& row = find_controller("pid");
  EXPECT_FALSE(row.summary.empty());
  ASSERT_EQ(row.gains.size(), 3u);
  EXPECT_STREQ(row.gains[0].name, "p");
  EXPECT_STREQ(row.gains[0].key, "p_n_m_per_rad");
  EXPECT_STREQ(row.gains[0].unit, "N m/rad");
  EXPECT_STREQ(row.gains[1].name, "i");
  EXPECT_STREQ(row.gains[1].key, "i_n_m_per_rad_s");
  EXPECT_STREQ(row.gains[1].unit, "N m/(rad s)");
  EXPECT_STREQ(row.gains[2].name, "d");
  EXPECT_STREQ(row.gains[2].key, "d_n_m_s_per_rad");
  EXPECT_STREQ(row.gains[2].unit, "N m s/rad");
}

TEST(ControllerTable, MakesTheControllerItNames) {
  const std::array<double, 3> gains = {100, 50, 2};
  const auto controller = find_controller("pid").make(gains, {-30, 40}, JointKind::revolute);
  for (const PidStep& step : kByHand) {
    EXPECT_NEAR(controller->step(step.setpoint_rad, step.measurement_rad, 0.1), step.effort_n_m,
                kPidTolerance);
  }
}

TEST(ControllerTable, MakesItForTheKindOfJoint) {
  const std::array<double, 3> gains = {10, 0, 0};
  const ControllerRow& row = find_controller("pid");
  const EffortLimits limits{-1000, 1000};
  EXPECT_EQ(row.make(gains, limits, JointKind::prismatic)->step(5, -5, 0.01), 100);
  EXPECT_NEAR(row.make(gains, limits, JointKind::revolute)->step(5, -5, 0.01), 10 * (10 - 4 * kPi),
              kPidTolerance);
}

TEST(ControllerTable, NamesWhatItDoesNotKnow) {
  EXPECT_THAT(usage_message([] { find_controller("pidd"); }),
              testing::StartsWith("unknown controller 'pidd'; did you mean 'pid'? Valid: pid, "));
  const std::array<double, 2> two = {100, 50};
  EXPECT_EQ(usage_message([&] {
              find_controller("pid").make(two, {-1, 1}, JointKind::revolute);
            }),
            "controller 'pid': 2 gains are given; it takes exactly 3: p, i, d");
}

}  // namespace
}  // namespace armwright
