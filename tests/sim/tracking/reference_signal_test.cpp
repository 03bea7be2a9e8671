#include "sim/tracking/reference_signal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

constexpr double kAcceleration = 15;  // m/s^2, the thesis's

// A few operations on numbers of at most the distance's size, each rounded by half an ulp.
double rounding(double distance_m) {
  return 8 * std::numeric_limits<double>::epsilon() * distance_m;
}

double calc_slope(const targets::SignalCurve& signal, double from_s, double to_s) {
  return (calc_distance(signal, to_s) - calc_distance(signal, from_s)) / (to_s - from_s);
}

double calc_curvature(const targets::SignalCurve& signal, double t_s, double h_s) {
  return (calc_distance(signal, t_s + h_s) - 2 * calc_distance(signal, t_s) +
          calc_distance(signal, t_s - h_s)) /
         (h_s * h_s);
}

struct Motion {
  SignalShape shape;
  double distance_m;
  double speed_m_per_s;
};

// All shapes but the step, which has its own test below because it arrives at once.
class EveryMovingSignal : public testing::TestWithParam<Motion> {
 protected:
  targets::SignalCurve signal_ = make_signal_curve(GetParam().shape, GetParam().distance_m,
                                                   GetParam().speed_m_per_s, kAcceleration);
  double distance_m_ = GetParam().distance_m;
  double speed_m_per_s_ = GetParam().speed_m_per_s;
};

TEST_P(EveryMovingSignal, ArrivesExactlyAndStays) {
  const double end_s = signal_.duration_s;
  EXPECT_EQ(end_s, distance_m_ / speed_m_per_s_);
  for (const double t_s : {end_s, std::nextafter(end_s, 1e9), end_s + 0.5, 1e9}) {
    EXPECT_EQ(calc_distance(signal_, t_s), distance_m_) << t_s;
  }
}

TEST_P(EveryMovingSignal, StartsAtZero) {
  EXPECT_EQ(calc_distance(signal_, 0), 0.0);
}

TEST_P(EveryMovingSignal, NeverGoesBackNorBeyond) {
  constexpr int kSamples = 10007;
  double previous_m = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const double s_m = calc_distance(signal_, signal_.duration_s * i / kSamples);
    ASSERT_GE(s_m, previous_m - rounding(distance_m_)) << i;
    ASSERT_LE(s_m, distance_m_) << i;
    previous_m = s_m;
  }
}

// No shape is ever faster than 2.5 v, so a jump between its pieces would show as a steeper slope.
TEST_P(EveryMovingSignal, HasNoJumps) {
  constexpr int kSamples = 10007;
  const double dt_s = signal_.duration_s / kSamples;
  for (int i = 0; i < kSamples; ++i) {
    ASSERT_LE(calc_distance(signal_, (i + 1) * dt_s) - calc_distance(signal_, i * dt_s),
              2.5 * speed_m_per_s_ * dt_s + rounding(distance_m_))
        << i;
  }
}

// Backward difference over h = 1e-4 t_m. It differs from the end speed by a h / 2 where the signal
// brakes with a (at most 15 m/s^2, or 4 v / t_m if that is less), and by (125/54) (h / t_m)^2 v for
// the complex one.
TEST_P(EveryMovingSignal, EndsAtItsOwnSpeed) {
  constexpr double kShare = 1e-4;
  const double end_s = signal_.duration_s;
  const double speed = calc_slope(signal_, end_s * (1 - kShare), end_s);
  const double noise = rounding(speed_m_per_s_) / kShare;
  switch (GetParam().shape) {
    case SignalShape::step:
      FAIL() << "a step does not move";
    case SignalShape::ramp:
      EXPECT_NEAR(speed, speed_m_per_s_, noise);
      break;
    case SignalShape::trapezoid:
    case SignalShape::triangular: {
      EXPECT_GT(speed, 0);
      EXPECT_LE(speed,
                0.5 * std::max(kAcceleration, 4 * speed_m_per_s_ / end_s) * kShare * end_s + noise);
      break;
    }
    case SignalShape::complex:
      EXPECT_NEAR(speed, 125.0 / 54.0 * kShare * kShare * speed_m_per_s_, noise);
      break;
  }
}

std::vector<Motion> make_motions() {
  std::vector<Motion> motions;
  for (const SignalShape shape :
       {SignalShape::ramp, SignalShape::trapezoid, SignalShape::triangular, SignalShape::complex}) {
    motions.push_back({shape, 1.376, 1.5});    // the trapezoid has a plateau
    motions.push_back({shape, 0.0541, 0.61});  // slow
    motions.push_back({shape, 0.226, 1.73});   // the trapezoid becomes triangular
  }
  return motions;
}

INSTANTIATE_TEST_SUITE_P(Motions, EveryMovingSignal, testing::ValuesIn(make_motions()),
                         [](const testing::TestParamInfo<Motion>& motion) {
                           return signal_names()[static_cast<std::size_t>(motion.param.shape)] +
                                  std::to_string(motion.index % 3);
                         });

TEST(ReferenceSignal, StepIsThereAtOnce) {
  const auto signal = make_signal_curve(SignalShape::step, 0.7, 1.4, kAcceleration);
  EXPECT_EQ(signal.duration_s, 0.5);  // the error is measured from here on, too
  EXPECT_EQ(calc_distance(signal, 0.0), 0.7);
  EXPECT_EQ(calc_distance(signal, 0.2), 0.7);
  EXPECT_EQ(calc_distance(signal, 0.5), 0.7);
  EXPECT_EQ(calc_distance(signal, 7.0), 0.7);
}

// v t_m is not always ds in floating point.
TEST(ReferenceSignal, RampsArriveExactlyWhateverTheRounding) {
  int rounded = 0;
  for (int i = 1; i <= 1000; ++i) {
    const double distance_m = 0.0017 * i;
    const auto signal = make_signal_curve(SignalShape::ramp, distance_m, 1.3, kAcceleration);
    ASSERT_EQ(calc_distance(signal, signal.duration_s), distance_m);
    ASSERT_LE(calc_distance(signal, std::nextafter(signal.duration_s, 0.0)), distance_m);
    rounded += 1.3 * signal.duration_s != distance_m;
  }
  EXPECT_GT(rounded, 0);  // else this test would check nothing
}

TEST(ReferenceSignal, RampIsSpeedTimesTime) {
  const auto signal = make_signal_curve(SignalShape::ramp, 1.2, 1.5, kAcceleration);
  EXPECT_NEAR(calc_distance(signal, 0.3), 0.45, rounding(1.2));
  EXPECT_NEAR(calc_distance(signal, 0.79), 1.185, rounding(1.2));
}

// ds = 1 m, v = 1.5 m/s. t = 0.1 s: 25 x 2.25 x 0.01 / 8 = 0.0703125. t = 0.5 s: 1 - 125 x 0.25^3 /
// 54 = 1 - 1.953125 / 54.
TEST(ReferenceSignal, ComplexByHand) {
  const auto signal = make_signal_curve(SignalShape::complex, 1.0, 1.5, kAcceleration);
  EXPECT_NEAR(calc_distance(signal, 0.1), 0.0703125, rounding(1));
  EXPECT_NEAR(calc_distance(signal, 0.5), 1 - 1.953125 / 54, rounding(1));
}

// The slope over e t_m beside the peak misses it by half of the curvature: (25/8) e v before,
// (25/6) e v after.
TEST(ReferenceSignal, ComplexPeaksAtTwoAndAHalfTimesTheAverageSpeed) {
  constexpr double kShare = 1e-5;
  const double speed = 1.37;
  const auto signal = make_signal_curve(SignalShape::complex, 0.753, speed, kAcceleration);
  const double peak_s = 0.4 * signal.duration_s;
  const double h_s = kShare * signal.duration_s;
  EXPECT_NEAR(calc_distance(signal, peak_s), 0.753 / 2, rounding(0.753));
  EXPECT_NEAR(calc_distance(signal, std::nextafter(peak_s, 1.0)), 0.753 / 2, rounding(0.753));
  const double noise = rounding(speed) / kShare;
  EXPECT_NEAR(calc_slope(signal, peak_s - h_s, peak_s), speed * (2.5 - 25.0 / 8.0 * kShare), noise);
  // ... and 125/54 e^2, the cubic's own term
  EXPECT_NEAR(calc_slope(signal, peak_s, peak_s + h_s),
              speed * (2.5 - 25.0 / 6.0 * kShare + 125.0 / 54.0 * kShare * kShare), noise);
}

// ds = 1.2 m, v = 1.5 m/s, a = 15 m/s^2: t_m = 0.8 s, t_a = (0.8 - sqrt(0.64 - 0.32)) / 2 = 0.4 -
// sqrt(0.08) s.
TEST(ReferenceSignal, TrapezoidByHand) {
  const auto signal = make_signal_curve(SignalShape::trapezoid, 1.2, 1.5, 15);
  const double ramp_up_s = 0.4 - std::sqrt(0.08);
  EXPECT_NEAR(calc_distance(signal, 0.1), 0.075, rounding(1.2));  // 15 / 2 x 0.1^2
  EXPECT_NEAR(calc_distance(signal, 0.7), 1.125, rounding(1.2));
  EXPECT_NEAR(calc_distance(signal, 0.4), 0.6, rounding(1.2));
  EXPECT_NEAR(calc_distance(signal, 0.3), 0.6 - 0.1 * 15 * ramp_up_s, rounding(1.2));
  // The second difference of a quadratic is exact but for rounding, which 1 / h^2 magnifies.
  constexpr double kStep_s = 1e-3;
  const double noise = 4 * rounding(1.2) / (kStep_s * kStep_s);
  EXPECT_NEAR(calc_curvature(signal, 0.06, kStep_s), 15, noise);
  EXPECT_NEAR(calc_curvature(signal, 0.42, kStep_s), 0, noise);
  EXPECT_NEAR(calc_curvature(signal, 0.74, kStep_s), -15, noise);
}

TEST(ReferenceSignal, TriangularByHand) {
  const auto signal = make_signal_curve(SignalShape::triangular, 0.6, 1.5,
                                        1e-9);                    // acceleration not used
  EXPECT_NEAR(calc_distance(signal, 0.1), 0.075, rounding(0.6));  // 4 ds / t_m^2 = 15 m/s^2
  EXPECT_NEAR(calc_distance(signal, 0.2), 0.3, rounding(0.6));
  EXPECT_NEAR(calc_distance(signal, 0.3), 0.525, rounding(0.6));
}

// ds = 0.6 m at v = 1.5 m/s needs at least a = 4 v^2 / ds = 15 m/s^2. With (1 + d) times that, t_a
// falls short of t_m / 2 by the fraction sqrt(d / (1 + d)), so that no point of the path moves by
// more than ds sqrt(d).
TEST(ReferenceSignal, TrapezoidFallsBackToTriangularWhereItsAccelerationIsTooSmall) {
  const auto triangular = make_signal_curve(SignalShape::triangular, 0.6, 1.5, 15);
  constexpr double kExcess = 1e-6;
  const auto below = make_signal_curve(SignalShape::trapezoid, 0.6, 1.5, 15 * (1 - kExcess));
  const auto far_below = make_signal_curve(SignalShape::trapezoid, 0.6, 1.5, 0.3);
  const auto above = make_signal_curve(SignalShape::trapezoid, 0.6, 1.5, 15 * (1 + kExcess));
  const auto far_above = make_signal_curve(SignalShape::trapezoid, 0.6, 1.5, 30);
  double largest_m = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double t_s = 0.4 * i / 1000;
    const double expected_m = calc_distance(triangular, t_s);
    ASSERT_EQ(calc_distance(below, t_s), expected_m) << t_s;
    ASSERT_EQ(calc_distance(far_below, t_s), expected_m) << t_s;
    ASSERT_NEAR(calc_distance(above, t_s), expected_m, 0.6 * std::sqrt(kExcess)) << t_s;
    largest_m = std::max(largest_m, std::abs(calc_distance(far_above, t_s) - expected_m));
  }
  const auto little_above = make_signal_curve(SignalShape::trapezoid, 0.6, 1.5, 16.5);
  EXPECT_NEAR(calc_distance(little_above, 0.05), 0.5 * 16.5 * 0.0025, rounding(0.6));
  // At 30 m/s^2, t_a = 0.2 (1 - sqrt(1/2)): well ahead of the triangular signal at that time.
  const double ramp_up_s = 0.2 * (1 - std::sqrt(0.5));
  EXPECT_GE(largest_m, 0.99 * 0.5 * 15 * ramp_up_s * ramp_up_s);
}

// t_a = v / a to first order: the plateau's speed is v (1 + v / (a t_m)). Cancellation in t_a would
// show as 1e-4 here.
TEST(ReferenceSignal, TrapezoidKeepsItsPrecisionAtHugeAccelerations) {
  const auto signal = make_signal_curve(SignalShape::trapezoid, 1.2, 1.5, 1e12);
  EXPECT_NEAR(calc_slope(signal, 0.2, 0.6), 1.5, 1e-11);
}

TEST(ReferenceSignal, TrapezoidAndTriangularBrakeAsTheyAccelerate) {
  for (const SignalShape shape : {SignalShape::trapezoid, SignalShape::triangular}) {
    const auto signal = make_signal_curve(shape, 1.018, 1.31, 17.3);
    for (int i = 0; i <= 100; ++i) {
      const double t_s = signal.duration_s * i / 100;
      EXPECT_NEAR(calc_distance(signal, t_s) + calc_distance(signal, signal.duration_s - t_s),
                  1.018, 4 * rounding(1.018))
          << t_s;
    }
  }
}

TEST(ReferenceSignal, NamesFollowTheEnum) {
  EXPECT_THAT(signal_names(),
              testing::ElementsAre("step", "ramp", "trapezoid", "triangular", "complex"));
  EXPECT_EQ(find_signal("step"), SignalShape::step);
  EXPECT_EQ(find_signal("ramp"), SignalShape::ramp);
  EXPECT_EQ(find_signal("trapezoid"), SignalShape::trapezoid);
  EXPECT_EQ(find_signal("triangular"), SignalShape::triangular);
  EXPECT_EQ(find_signal("complex"), SignalShape::complex);
  EXPECT_EQ(usage_message([] { find_signal("trapezoit"); }),
            "unknown reference signal 'trapezoit'; did you mean 'trapezoid'? Valid: step, ramp, "
            "trapezoid, triangular, complex");
}

TEST(ReferenceSignal, RefusesImpossibleMotions) {
  const auto refusal = [](SignalShape shape, double distance_m, double speed, double acceleration) {
    return usage_message([=] { make_signal_curve(shape, distance_m, speed, acceleration); });
  };
  for (const double bad : {0.0, -0.3, kInfinity, kNan}) {
    EXPECT_THAT(refusal(SignalShape::ramp, bad, 1.5, 15),
                HasSubstr("the distance is " +
                          std::string(bad == 0     ? "0"
                                      : bad < 0    ? "-0.3"
                                      : bad == bad ? "inf"
                                                   : "nan") +
                          " m; it must be finite and > 0"));
    EXPECT_THAT(refusal(SignalShape::complex, 0.5, bad, 15), HasSubstr("the speed is "));
    EXPECT_THAT(refusal(SignalShape::trapezoid, 0.5, 1.5, bad), HasSubstr("the acceleration is "));
    EXPECT_EQ(refusal(SignalShape::complex, 0.5, 1.5, bad), "(no error)");  // not used
  }
  EXPECT_THAT(refusal(SignalShape::ramp, 1e200, 1e-200, 15),
              HasSubstr("the duration (distance / speed) is inf s; it must be finite and > 0"));
}

}  // namespace
}  // namespace armwright
