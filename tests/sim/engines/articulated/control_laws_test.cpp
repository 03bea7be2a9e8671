// Tests every control law: against numbers computed by hand, for the properties that all laws
// share, and in SIMD lanes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "sim/controllers/controller.hpp"
#include "sim/controllers/fuzzy.hpp"
#include "sim/controllers/neural.hpp"
#include "sim/engines/articulated/kernels.hpp"
#include "sim/engines/articulated/lane_block.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

// Numbers of size 100 computed with errors of 2^-53, magnified by gains over h.
constexpr double kLawTolerance = 1e-11;

struct LawStep {
  double setpoint, measurement, effort;
  double feed_forward = 0;
};

void expect_steps(const std::string& name, const std::vector<double>& gains, EffortLimits limits,
                  const std::vector<LawStep>& steps) {
  const auto controller = find_controller(name).make(gains, limits, JointKind::revolute);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const LawStep& step = steps[i];
    EXPECT_NEAR(controller->step(step.setpoint, step.measurement, 0.1, step.feed_forward),
                step.effort, kLawTolerance)
        << name << ", step " << i;
  }
}

// P 100, I 50, I2 20, D 2, h 0.1.
TEST(ControlLaws, Pi2dByHand) {
  expect_steps("pi2d", {100, 50, 20, 2}, {-30, 30},
               {{0.2, 0, 21.04},    // e 0.2, S 0.02, SS 0.002: 20 + 1 + 0.04
                {0.2, 0, 22.12},    // S 0.04, SS 0.006: 20 + 2 + 0.12
                {0.2, -0.1, 30},    // e 0.3, S 0.07, SS 0.013: 30 + 3.5 + 0.26 + 2, clamped
                {0.2, 0, 21.76},    // e 0.2, both kept: 20 + 3.5 + 0.26 - 2
                {0.2, 0, 24.94}});  // S 0.09, SS 0.022: 20 + 4.5 + 0.44
}

// P 100, I 50, D 2, T 0.1, b 0.5, c 0.25, h 0.1.
TEST(ControlLaws, PidFilteredByHand) {
  expect_steps("pid_filtered", {100, 50, 2, 0.1, 0.5, 0.25}, {-1000, 1000},
               {{0.2, 0, 21},         // e 0.2, S 0.02, w 0, f 0: 20 + 1
                {0.4, 0.1, 22},       // e 0.3, S 0.05, w 0.2, f -0.25: 100 x 0.2 + 2.5 - 0.5
                {0.4, 0.2, 12.25}});  // e 0.2, S 0.07, f -0.625: 100 x 0.1 + 3.5 - 1.25
}

TEST(ControlLaws, PidFilteredIsThePidWithoutFilterAndWeights) {
  const auto filtered =
      find_controller("pid_filtered")
          .make(std::vector<double>{100, 50, 2, 0, 1, 1}, {-30, 40}, JointKind::revolute);
  const auto pid = make_pid(100, 50, 2, {-30, 40});
  RandomStream random("test/sim/filtered", 1);
  for (int i = 0; i < 100; ++i) {
    const double setpoint = random.uniform(-3, 3);
    const double measurement = setpoint + random.uniform(-0.3, 0.3);
    EXPECT_NEAR(filtered->step(setpoint, measurement, 0.1), pid->step(setpoint, measurement, 0.1),
                kLawTolerance);
  }
}

// The setpoint moves from 3.13 past pi: by 0.04, not by 0.04 - 2 pi.
TEST(ControlLaws, TheWeighedSetpointDoesNotSeeTheWrap) {
  expect_steps("pid_filtered", {100, 0, 0, 0, 0.5, 1}, {-1000, 1000},
               {{3.13, 3.13, 0}, {3.17 - 2 * kPi, 3.13, 100 * (0.04 - 0.5 * 0.04)}});
}

TEST(ControlLaws, FeedForwardIsAddedByItsShare) {
  for (const char* name : {"pid_gravity", "pid_computed_torque"}) {
    expect_steps(name, {100, 50, 2, 0.5}, {-30, 30},
                 {{0.2, 0, 24.5, 7},  // 20 + 1 + 0.5 x 7
                  {0.2, 0, 30, 20},   // 20 + 2 + 10, clamped
                  {0.2, 0, 15, -14},  // 20 + 2 kept - 7
                  {0.3, 0, 30, 1e9}});
  }
}

// kp 10, kv 5, ki 20, share 0.5, h 0.1.
TEST(ControlLaws, CascadeByHand) {
  expect_steps("cascade", {10, 5, 20, 0.5}, {-1000, 1000},
               {{0.2, 0, 14},      // e_v = 10 x 0.2, sum 0.2: 10 + 4
                {0.3, 0.1, 14.5},  // e_v = 2 + 0.5 x 1 - 1, sum 0.35: 7.5 + 7
                {0.3, 0.3, -7}});  // e_v = 0 + 0 - 2, sum 0.15: -10 + 3
}

// p 10, i 20, d 0.5, ff 0.8, h 0.1.
TEST(ControlLaws, PidVelocityByHand) {
  expect_steps("pid_velocity", {10, 20, 0.5, 0.8}, {-9, 9},
               {{0.2, 0, 2.4},       // e 0.2, S 0.02: 2 + 0.4
                {0.3, 0.2, 1.9},     // e 0.1, S 0.03: 0.8 x 1 + 1 + 0.6 - 0.5
                {1.3, 0.3, 9},       // clamped
                {1.3, 1.2, -0.9}});  // e 0.1, S 0.13 kept: 1 + 2.6 - 0.5 x 9
}

// p 0.5, i 2, d 0.1, h 0.1.
TEST(ControlLaws, PidPositionByHand) {
  expect_steps("pid_position", {0.5, 2, 0.1}, {-10, 10},
               {{0.2, 0, 0.34},      // 0.2 + 0.1 + 2 x 0.02
                {0.3, 0.2, 0.31}});  // 0.3 + 0.05 + 2 x 0.03 - 0.1
}

// If it starts at rest on its target: sum(e_v) h = kp sum(e) h + e.
TEST(ControlLaws, CascadeIsAPidInDisguise) {
  const double kp = 12, kv = 5, ki = 20;
  const auto cascade = find_controller("cascade").make(std::vector<double>{kp, kv, ki, 1},
                                                       {-1e6, 1e6}, JointKind::revolute);
  const auto pid = make_pid(kv * kp + ki, ki * kp, kv, {-1e6, 1e6});
  for (int i = 0; i < 200; ++i) {
    const double setpoint = std::sin(0.05 * i);
    const double measurement = i == 0 ? 0 : std::sin(0.05 * i - 0.1) + 0.01 * i;
    EXPECT_NEAR(cascade->step(setpoint, measurement, 0.01), pid->step(setpoint, measurement, 0.01),
                1e-9);
  }
}

TEST(ControlLaws, NeuralByHand) {
  std::vector<double> gains(16, 0.0);
  gains[0] = 1;     // w1_error
  gains[5] = 0.5;   // w2_integral
  gains[10] = -2;   // w3_rate
  gains[11] = 0.3;  // w3_bias
  gains[12] = 2;    // v1, v2, v3, v_bias
  gains[13] = -3;
  gains[14] = 0.25;
  gains[15] = 0.1;
  const double first =
      10 * (0.1 + 2 * std::tanh(0.2) - 3 * std::tanh(0.5 * 0.02) + 0.25 * std::tanh(0.3));
  // e 0.03, S 0.005, rate 0.1; L is 10.
  const double second =
      10 * (0.1 + 2 * std::tanh(0.3) - 3 * std::tanh(0.5 * 0.05) + 0.25 * std::tanh(0.3 - 2 * 0.1));
  expect_steps("neural", gains, {-10, 8}, {{0.5, 0.48, first}, {0.5, 0.47, second}});
}

using FuzzyNumber = lanes::Single<double, struct FuzzyLevel>;

double calc_table(double error, double rate, std::vector<double> gains) {
  std::vector<FuzzyNumber> own(gains.begin(), gains.end());
  return controllers::FuzzyTable::calc<FuzzyNumber>(error, rate, {own.data(), 1}).v;
}

// The definition, with all 25 rules.
double calc_table_plainly(double error, double rate, const std::vector<double>& gains) {
  const auto calc_set = [](double value, double span, int k) {
    const double x = std::clamp(value / span, -1.0, 1.0);
    return std::max(0.0, 1 - 2 * std::abs(x - 0.5 * k));
  };
  const auto get_weight = [&](int k, int l) {
    const double sign = k < 0 || (k == 0 && l < 0) ? -1 : 1;
    const int row = std::abs(k);
    const int column = sign > 0 ? l : -l;
    if (row == 0) {
      return column == 0 ? 0 : sign * gains[static_cast<std::size_t>(1 + column)];
    }
    return sign * gains[static_cast<std::size_t>(5 * row + 1 + column)];
  };
  double y = 0;
  for (int k = -2; k <= 2; ++k) {
    for (int l = -2; l <= 2; ++l) {
      y += calc_set(error, gains[0], k) * calc_set(rate, gains[1], l) * get_weight(k, l);
    }
  }
  return y;
}

TEST(ControlLaws, FuzzyTableIsTheSumOfAllRules) {
  RandomStream random("test/sim/fuzzy", 1);
  std::vector<double> gains = {0.02, 0.5};
  for (int k = 0; k < controllers::FuzzyTable::kWeightCount; ++k) {
    gains.push_back(random.uniform(-2, 2));
  }
  for (int i = 0; i < 10000; ++i) {
    const double error = random.uniform(-0.03, 0.03);
    const double rate = random.uniform(-0.7, 0.7);
    EXPECT_NEAR(calc_table(error, rate, gains), calc_table_plainly(error, rate, gains), 1e-14);
    EXPECT_EQ(calc_table(error, rate, gains), -calc_table(-error, -rate, gains));
  }
  // The weights have the names of their rules: a small positive error and a big negative rate.
  const auto names = controllers::FuzzyTable::kWeights;
  EXPECT_STREQ(names[2].name, "w_ps_nb");
  EXPECT_NEAR(calc_table(0.01, -0.5, gains), gains[4], 1e-15);
  EXPECT_STREQ(names[0].name, "w_ze_ps");
  EXPECT_NEAR(calc_table(0, 0.25, gains), gains[2], 1e-15);
  EXPECT_STREQ(names[11].name, "w_pb_pb");
  EXPECT_NEAR(calc_table(7, 7, gains), gains[13], 1e-15);
  EXPECT_TRUE(std::isnan(calc_table(std::nan(""), 0, gains)));
  EXPECT_TRUE(std::isnan(calc_table(0, std::nan(""), gains)));
  gains[0] = 0;  // a span of 0 makes a switch
  EXPECT_EQ(calc_table(0, 0, gains), 0);
  EXPECT_NEAR(calc_table(1e-9, 0, gains), gains[11], 1e-15);
}

// w_kl = alpha c_k + beta c_l gives alpha x1 + beta x2. Rounding: some 20 products of numbers up to 3.
TEST(ControlLaws, ALinearFuzzyTableIsPd) {
  RandomStream random("test/sim/fuzzy", 2);
  std::vector<double> gains(14, 0.02);
  controllers::FuzzyTable::set_linear(1.7, -0.6, &gains[2]);
  for (int i = 0; i < 10000; ++i) {
    const double x1 = random.uniform(-1.5, 1.5);
    const double x2 = random.uniform(-1.5, 1.5);
    EXPECT_NEAR(calc_table(0.02 * x1, 0.02 * x2, gains),
                1.7 * std::clamp(x1, -1.0, 1.0) - 0.6 * std::clamp(x2, -1.0, 1.0), 1e-14);
  }
}

// E 0.2, R 4, L 5, h 0.1.
TEST(ControlLaws, FuzzyByHand) {
  std::vector<double> gains = {0.2, 4, 0.3, 0.7, -1, -0.2, 0.4, 0.9, 1, -1.5, 0, 1.1, 1.3, 2, 5};
  expect_steps("fuzzy", gains, {-8, 8},
               {{0.15, 0, 5 * (0.5 * 0.4 + 0.5 * 1.1)},  // x1 0.75, x2 0
                {0.25, 0, 5 * (0.5 * 1.1 + 0.5 * 1.3)},  // x1 1, x2 0.25
                {-0.3, 0, -8}});                         // x1 -1, x2 -1: -10, clamped
}

// P 100, I 50, D 2, E 0.2, R 4, S 0.05, h 0.1. The only rule: w_ps_ze 0.8.
TEST(ControlLaws, FuzzyReferenceByHand) {
  std::vector<double> gains = {100, 50, 2, 0.2, 4, 0, 0, 0, 0, 0.8, 0, 0, 0, 0, 0, 0, 0, 0.05};
  expect_steps("fuzzy_reference", gains, {-100, 100},
               {{0.1, 0, 14.7},       // f 0.14, S 0.014: 14 + 0.7
                {0.15, 0, 18.525}});  // x1 0.75, x2 0.125, y 0.8 x 0.5 x 0.75: f 0.165, S 0.0305
}

TEST(ControlLaws, TanhIsWithinItsBounds) {
  using Double = lanes::Single<double, struct TestLevel>;
  using Float = lanes::Single<float, struct TestLevel>;
  double worst = 0;
  double worst_float = 0;
  for (double x = -25; x < 25; x += 1.0 / 1024) {
    worst = std::max(worst, std::abs(controllers::calc_tanh(Double(x)).v - std::tanh(x)));
    const auto single = static_cast<float>(x);
    worst_float = std::max(worst_float,
                           std::abs(static_cast<double>(controllers::calc_tanh(Float(single)).v) -
                                    std::tanh(static_cast<double>(single))));
  }
  EXPECT_LT(worst, 1e-15);
  EXPECT_GT(worst, 0);
  EXPECT_LT(worst_float, 1e-6);
  // Small arguments keep their digits.
  for (double x = 1; x > 1e-300; x *= 0.37) {
    EXPECT_NEAR(controllers::calc_tanh(Double(x)).v / std::tanh(x), 1, 1e-14);
  }
  EXPECT_TRUE(std::isnan(controllers::calc_tanh(Double(std::nan(""))).v));
}

class EveryController : public testing::TestWithParam<std::string> {
 protected:
  const ControllerRow& row() const { return find_controller(GetParam()); }
  bool has_integral() const { return GetParam() != "fuzzy"; }
  // The thesis's second joint before tuning.
  std::vector<double> make_gains() const {
    std::vector<double> gains(row().gains.size());
    row().convert({270000, 700000, 30000, 45000, 0.01}, gains.data());
    return gains;
  }
  std::unique_ptr<Controller> make(JointKind kind = JointKind::revolute) const {
    return row().make(make_gains(), limits(), kind);
  }
  // Limits that an error of 1 exceeds and one of 0.01 does not.
  EffortLimits limits() const {
    switch (row().interface) {
      case ControlInterface::velocity:
        return {-40, 45};
      case ControlInterface::position:
        return {-0.9, 0.95};
      case ControlInterface::effort:
        break;
    }
    return {-40000, 45000};
  }
};

TEST_P(EveryController, SaysWhatItIs) {
  EXPECT_FALSE(row().summary.empty());
  EXPECT_THAT(row().formula, testing::HasSubstr(" = "));
  std::set<std::string> names;
  for (const controllers::Gain& gain : row().gains) {
    EXPECT_TRUE(names.insert(gain.name).second) << gain.name;
    EXPECT_TRUE(names.insert(gain.key).second || std::string_view(gain.key) == gain.name)
        << gain.key;
    EXPECT_STRNE(gain.unit, "");
    EXPECT_GE(gain.range, 0);
    EXPECT_TRUE(gain.range > 0 || !gain.any_sign) << "a factor keeps the sign";
  }
}

TEST_P(EveryController, StartsWithUsableGains) {
  const auto gains = make_gains();
  for (std::size_t k = 0; k < gains.size(); ++k) {
    const controllers::Gain& spec = row().gains[k];
    EXPECT_TRUE(std::isfinite(gains[k])) << spec.name;
    EXPECT_TRUE(spec.any_sign || gains[k] >= 0) << spec.name;
    EXPECT_TRUE(spec.range > 0 || gains[k] > 0) << spec.name;
  }
}

// For small and slow errors, a controller converted from a PID gives almost the same effort as that
// PID, to a quarter. A law without an integral does not take over the PID's.
TEST_P(EveryController, StartsNearThePid) {
  if (row().interface != ControlInterface::effort) {
    GTEST_SKIP() << "commands no effort";
  }
  const auto controller = make();
  const auto pid = make_pid(270000, has_integral() ? 700000 : 0, 30000, limits());
  double largest = 0;
  double difference = 0;
  for (int k = 0; k < 100; ++k) {
    const double error = 0.02 * std::sin(0.08 * k);
    const double expected = pid->step(0.5, 0.5 - error, 0.01);
    largest = std::max(largest, std::abs(expected));
    difference =
        std::max(difference, std::abs(controller->step(0.5, 0.5 - error, 0.01) - expected));
  }
  EXPECT_GT(largest, 1000);
  EXPECT_LT(difference, 0.25 * largest);
}

TEST_P(EveryController, ClampsAndSaysSo) {
  const auto controller = make();
  EXPECT_FALSE(controller->saturated());
  EXPECT_EQ(controller->step(1, 0, 0.01), limits().max);
  EXPECT_TRUE(controller->saturated());
  controller->reset();
  EXPECT_FALSE(controller->saturated());
  EXPECT_EQ(controller->step(-1, 0, 0.01), limits().min);
  EXPECT_TRUE(controller->saturated());
  controller->reset();
  controller->step(0.001, 0, 0.01);
  EXPECT_FALSE(controller->saturated());
}

// A long saturation does not change the later efforts; filters have settled after 30 steps.
TEST_P(EveryController, DoesNotWindUp) {
  const auto brief = make();
  const auto lasting = make();
  for (int k = 0; k < 30; ++k) {
    brief->step(1, 0, 0.01);
  }
  for (int k = 0; k < 3000; ++k) {
    lasting->step(1, 0, 0.01);
  }
  EXPECT_TRUE(lasting->saturated());
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(brief->step(1, 0.99, 0.01), lasting->step(1, 0.99, 0.01), 1e-6);
  }
}

// If it is not clamped, it integrates.
TEST_P(EveryController, GrowsAgainstALastingError) {
  if (!has_integral()) {
    GTEST_SKIP() << "has no integral";
  }
  const auto controller = make();
  double before = controller->step(0.01, 0, 0.01);
  for (int k = 0; k < 50; ++k) {
    const double now = controller->step(0.01, 0, 0.01);
    EXPECT_GT(now, before);
    before = now;
  }
}

TEST_P(EveryController, ResetForgetsEverything) {
  const auto used = make();
  const auto fresh = make();
  used->step(2, 0.5, 0.01, 300);
  used->step(2.5, -0.1, 0.01, 100);
  used->reset();
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(used->step(0.1 * k, 0.099 * k, 0.01, 50), fresh->step(0.1 * k, 0.099 * k, 0.01, 50));
  }
}

TEST_P(EveryController, TurnsTheShortWayRoundButSlidesTheWholeWay) {
  if (row().interface == ControlInterface::position) {
    GTEST_SKIP() << "commands the position itself, and the drive turns the short way round";
  }
  const auto turning = make();
  const auto turned = make();
  const auto sliding = make(JointKind::prismatic);
  for (int k = 0; k < 30; ++k) {
    const double target = 3.1 + 0.01 * k;  // past pi after five steps
    const double wrapped = target > kPi ? target - 2 * kPi : target;
    const double measured = target - 0.005;
    EXPECT_NEAR(turning->step(wrapped, measured, 0.01), turned->step(target, measured, 0.01), 1e-5);
    sliding->step(wrapped, measured, 0.01);
    EXPECT_EQ(sliding->saturated(), target > kPi);
  }
}

TEST_P(EveryController, RefusesWhatCannotWork) {
  auto gains = make_gains();
  gains.push_back(1);
  EXPECT_THAT(usage_error_of([&] { row().make(gains, limits(), JointKind::revolute); }),
              testing::HasSubstr("gains are given; it takes exactly " +
                                 std::to_string(gains.size() - 1) + ": " + row().gains[0].name));
  gains.pop_back();
  gains.back() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(
      usage_error_of([&] { row().make(gains, limits(), JointKind::revolute); }),
      "controller '" + row().name + "': " + row().gains.back().key + " is nan; it must be finite");
}

// Compares each law on one number with the same law in lanes. One lane without fused operations has
// the same arithmetic and therefore the same bits. articulated_kernel_test compares the PID, which
// the kernels have inlined.
template <class T>
double compare_lanes(const ControllerRow& row, const std::vector<double>& gains, SimdLevel level,
                     EffortLimits limits) {
  using namespace articulated;
  const Kernel<T> kernel = get_kernels<T>(level).ideal;
  const auto lanes = static_cast<std::size_t>(kernel.lanes);
  constexpr int kJoints = 2;
  constexpr int kSteps = 200;
  const std::uint8_t flags[kJoints] = {0, kPrismatic};
  const auto gain_count = static_cast<int>(row.gains.size());
  const AlignedNumbers<T> state(
      static_cast<std::size_t>(calc_state_packs(kJoints) +
                               calc_control_packs(kJoints, row.states, gain_count)) *
      lanes);
  const auto number = [&](int pack, std::size_t lane) -> T& {
    return state.data()[static_cast<std::size_t>(pack) * lanes + lane];
  };
  std::vector<std::vector<double>> targets(lanes), feed_forward(lanes);
  std::vector<const double*> target_rows(lanes), feed_forward_rows(lanes);
  std::vector<std::unique_ptr<Controller>> alone;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    RandomStream random("test/sim/laws", lane);
    for (int k = 0; k < kSteps * kJoints; ++k) {
      targets[lane].push_back(random.uniform(-3.1, 3.1));
      feed_forward[lane].push_back(random.uniform(-9000, 9000));
    }
    target_rows[lane] = targets[lane].data();
    feed_forward_rows[lane] = feed_forward[lane].data();
    std::vector<double> own = gains;
    for (double& gain : own) {
      gain = static_cast<T>(gain * random.uniform(0.5, 2));
    }
    for (int joint = 0; joint < kJoints; ++joint) {
      number(kIntegrating * kJoints + joint, lane) = 1;
      number(kEffortMin * kJoints + joint, lane) = static_cast<T>(limits.min);
      number(kEffortMax * kJoints + joint, lane) = static_cast<T>(limits.max);
      for (int k = 0; k < gain_count; ++k) {
        number(calc_state_packs(kJoints) + (row.states + k) * kJoints + joint, lane) =
            static_cast<T>(own[static_cast<std::size_t>(k)]);
      }
      alone.push_back(
          row.make(own, limits, flags[joint] == 0 ? JointKind::revolute : JointKind::prismatic));
    }
  }
  SegmentCall<T> call;
  kernel.find_control(row.law, call.control);
  EXPECT_NE(call.control, nullptr);
  call.joints = kJoints;
  call.flags = flags;
  call.state = state.data();
  call.steps = kSteps;
  call.period_s = static_cast<T>(0.01);
  call.first_step_of_case = true;
  call.targets = target_rows.data();
  call.feed_forward = feed_forward_rows.data();
  double worst = 0;
  int clamped = 0;
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (int joint = 0; joint < kJoints; ++joint) {
        const double target = targets[lane][static_cast<std::size_t>(step * kJoints + joint)];
        number(kQ * kJoints + joint, lane) = static_cast<T>(target - 0.05 * std::sin(0.2 * step));
      }
    }
    call.control(call, step);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (int joint = 0; joint < kJoints; ++joint) {
        const auto index = static_cast<std::size_t>(step * kJoints + joint);
        Controller& one = *alone[lane * kJoints + static_cast<std::size_t>(joint)];
        const double expected =
            one.step(static_cast<T>(targets[lane][index]), number(kQ * kJoints + joint, lane),
                     call.period_s, static_cast<T>(feed_forward[lane][index]));
        clamped += one.saturated() ? 1 : 0;
        worst = std::max(
            worst,
            std::abs(static_cast<double>(number(kEffort * kJoints + joint, lane)) - expected));
        EXPECT_EQ(number(kIntegrating * kJoints + joint, lane), one.saturated() ? 0 : 1);
      }
    }
  }
  EXPECT_GT(clamped, 0);
  EXPECT_LT(clamped, kSteps * kJoints * static_cast<int>(lanes));
  return worst;
}

TEST_P(EveryController, IsTheSameInLanes) {
  if (row().law == 0) {
    GTEST_SKIP() << "inlined in the kernels";
  }
  for (const std::string& name : supported_simd_names()) {
    const SimdLevel level = parse_simd(name);
    EffortLimits own = limits();
    if (!has_integral()) {
      own = {own.min / 2, own.max / 2};  // some steps exceed them
    }
    const double worst = compare_lanes<double>(row(), make_gains(), level, own);
    // Fused or not: roundings of 2^-53 of efforts up to 1e8 before they are clamped, some hundred.
    EXPECT_LT(worst, 1e-5) << name;
    if (level == SimdLevel::scalar) {
      EXPECT_EQ(worst, 0);
    }
  }
}

// Converted from a PID, its weights are 0.
TEST(FuzzyReference, WithRulesIsTheSameInLanes) {
  const ControllerRow& row = find_controller("fuzzy_reference");
  std::vector<double> gains(row.gains.size());
  row.convert({270000, 700000, 30000, 45000, 0.01}, gains.data());
  for (std::size_t k = 5; k < 17; ++k) {
    gains[k] = std::cos(static_cast<double>(k));
  }
  for (const std::string& name : supported_simd_names()) {
    const double worst = compare_lanes<double>(row, gains, parse_simd(name), {-40000, 45000});
    EXPECT_LT(worst, 1e-5) << name;
    if (parse_simd(name) == SimdLevel::scalar) {
      EXPECT_EQ(worst, 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryController, testing::ValuesIn(controller_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace armwright
