// Compares the curves with each other: a distance is the integral of the speed, and a speed is the
// integral of the acceleration. The quadrature is exact for polynomials of low degree.
#include "report/evidence/signals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

constexpr double kDistance_m = 0.83;
constexpr double kSpeed_m_per_s = 1.7;
constexpr double kAcceleration_m_per_s2 = 17;
constexpr double kRest_s = 0.4;

std::vector<SignalSample> sample(SignalShape shape) {
  return sample_signal(shape, kDistance_m, kSpeed_m_per_s, kAcceleration_m_per_s2, kRest_s);
}

class Signals : public testing::TestWithParam<SignalShape> {};

TEST_P(Signals, DistancesAreThoseOfTheTarget) {
  const auto signal =
      make_signal_curve(GetParam(), kDistance_m, kSpeed_m_per_s, kAcceleration_m_per_s2);
  const auto samples = sample(GetParam());
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].distance_m, calc_distance(signal, samples[i].time_s), 1e-14) << i;
    EXPECT_GE(samples[i].time_s, samples[i - 1].time_s);
  }
  EXPECT_EQ(samples.front().distance_m, 0);
  EXPECT_EQ(samples.back().distance_m, kDistance_m);
  EXPECT_DOUBLE_EQ(samples.back().time_s, kDistance_m / kSpeed_m_per_s + kRest_s);
}

// Simpson's rule needs the middle of an interval, which is every second sample of a piece. The rule
// is exact up to cubic polynomials.
TEST_P(Signals, SpeedsAndAccelerationsAreDerivatives) {
  const auto samples = sample(GetParam());
  double checked = 0;
  for (std::size_t i = 0; i + 2 < samples.size(); ++i) {
    const SignalSample& a = samples[i];
    const SignalSample& b = samples[i + 1];
    const SignalSample& c = samples[i + 2];
    const double h = c.time_s - a.time_s;
    const bool jumps = b.time_s == a.time_s || c.time_s == b.time_s;
    if (jumps || std::abs(b.time_s - a.time_s - h / 2) > 1e-12) {
      continue;
    }
    EXPECT_NEAR(c.distance_m - a.distance_m,
                h / 6 * (a.speed_m_per_s + 4 * b.speed_m_per_s + c.speed_m_per_s), 1e-13);
    EXPECT_NEAR(
        c.speed_m_per_s - a.speed_m_per_s,
        h / 6 * (a.acceleration_m_per_s2 + 4 * b.acceleration_m_per_s2 + c.acceleration_m_per_s2),
        1e-12);
    ++checked;
  }
  EXPECT_TRUE(GetParam() == SignalShape::step || checked > 50) << checked;
}

TEST_P(Signals, TheAreaUnderTheSpeedIsTheDistance) {
  if (GetParam() == SignalShape::step) {
    GTEST_SKIP() << "the step's speed would be infinite for an instant";
  }
  const auto samples = sample(GetParam());
  double area_m = 0;
  double largest = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    area_m += (samples[i].time_s - samples[i - 1].time_s) *
              (samples[i].speed_m_per_s + samples[i - 1].speed_m_per_s) / 2;
    largest = std::max(largest, samples[i].speed_m_per_s);
  }
  EXPECT_NEAR(area_m, kDistance_m, 1e-3 * kDistance_m);  // trapezoids, 60 per piece
  if (GetParam() == SignalShape::complex) {
    EXPECT_DOUBLE_EQ(largest, 2.5 * kSpeed_m_per_s);
  }
  if (GetParam() == SignalShape::triangular) {
    EXPECT_DOUBLE_EQ(largest, 2 * kSpeed_m_per_s);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Signals,
                         testing::Values(SignalShape::step, SignalShape::ramp,
                                         SignalShape::trapezoid, SignalShape::triangular,
                                         SignalShape::complex),
                         [](const auto& one) { return signal_names()[one.index]; });

TEST(SpeedReduction, IsProportionalBelowTheLimitAndWholeAbove) {
  TrackingTask task;
  task.speed_m_per_s = 1.2;
  task.distance_limit_m = 0.6;
  const auto signals = make_signals(task, true);
  EXPECT_EQ(signals["used"], "Complex");
  EXPECT_EQ(signals["distance_m"], 0.6);
  const auto& reduction = signals["reduction"];
  ASSERT_GT(reduction["distance_m"].size(), 10u);
  for (std::size_t i = 0; i < reduction["distance_m"].size(); ++i) {
    const double move_m = reduction["distance_m"][i];
    EXPECT_NEAR(reduction["speed_m_per_s"][i].get<double>(), 1.2 * std::min(1.0, move_m / 0.6),
                1e-14);
  }
  task.distance_limit_m = 0;
  const auto unlimited = make_signals(task, false);
  for (const auto& speed : unlimited["reduction"]["speed_m_per_s"]) {
    EXPECT_EQ(speed, 1.2);
  }
}

}  // namespace
}  // namespace armwright
