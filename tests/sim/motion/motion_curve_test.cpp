#include "sim/motion/motion_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace armwright {
namespace {

constexpr double kDeg = std::numbers::pi / 180;

// Four points of six joints, one row per joint (Fang et al. 2020 and Yu et al. 2025), in rad.
Eigen::MatrixXd make_gasparetto_points() {
  Eigen::MatrixXd points(6, 4);
  points << -10, 60, 20, 55, 20, 50, 120, 35, 15, 100, -10, 30, 150, 100, 40, 10, 30, 110, 90, 70,
      120, 60, 100, 25;
  return kDeg * points;
}

double sum_jerk(const MotionCurve& curve) {
  double sum = 0;
  for (std::size_t joint = 0; joint < curve.joint_count(); ++joint) {
    sum += curve.calc_jerk_integral(joint);
  }
  return sum;
}

double get_value(const MotionCurve& curve, double t, int order) {
  double value = 0;
  curve.calc(t, order, {&value, 1});
  return value;
}

// The intervals of the least duration have five decimals, so limits are met to about 1e-5.
TEST(CubicSpline, IsAtItsLimitsInTheLeastDurationOfGasparettosPoints) {
  const double h[] = {0.72771, 2.16044, 2.95972, 1.79609, 0.88700};
  const MotionCurve curve({}, make_gasparetto_points(), h);
  EXPECT_NEAR(curve.duration_s(), 8.530954, 1e-5);
  EXPECT_NEAR(sum_jerk(curve) / (kDeg * kDeg), 81381.4, 1);
  EXPECT_NEAR(curve.find_peak(0, 3).magnitude() / kDeg, 60, 1e-3);
  EXPECT_NEAR(curve.find_peak(1, 2).magnitude() / kDeg, 60, 1e-3);
  EXPECT_NEAR(curve.find_peak(1, 3).magnitude() / kDeg, 66, 1e-3);
  EXPECT_NEAR(curve.find_peak(2, 2).magnitude() / kDeg, 75, 1e-3);
}

TEST(CubicSpline, HasTheJerkOfTheUnlimitedOptimum) {
  double h[] = {0.08632, 0.27714, 0.29144, 0.26251, 0.08259};
  for (double& interval : h) {
    interval *= 9.1;
  }
  const MotionCurve curve({}, make_gasparetto_points(), h);
  // At a minimum, an error of 1e-5 in the shares changes the sum by its square.
  EXPECT_NEAR(sum_jerk(curve) / (kDeg * kDeg) * std::pow(9.1, 5) / 3.395311e9, 1, 1e-6);
  const double rms[] = {29.776, 31.798, 47.292, 7.821, 21.128, 36.568};
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_NEAR(std::sqrt(curve.calc_jerk_integral(joint) / curve.duration_s()) / kDeg, rms[joint],
                2e-3)
        << joint;
  }
}

TEST(CubicSpline, WithClampedEndsReachesTheLimitsAtItsOwnLeastDuration) {
  const double h[] = {2.60768, 2.71891, 2.72785};
  CurveForm form;
  form.ends = SplineEnds::clamped;
  const MotionCurve curve(form, make_gasparetto_points(), h);
  EXPECT_NEAR(curve.duration_s(), 8.054442, 1e-5);
  EXPECT_NEAR(curve.find_peak(1, 2).magnitude() / kDeg, 60, 1e-3);
  EXPECT_NEAR(curve.find_peak(2, 2).magnitude() / kDeg, 75, 1e-3);
}

// Every curve passes its points, rests at its ends, and is as smooth at its knots as promised.
TEST(MotionCurve, PassesItsPointsAndIsSmoothAtItsKnots) {
  Eigen::MatrixXd points(1, 4);
  points << 0.3, -1.1, 0.7, 0.2;
  for (const CurveKind kind : {CurveKind::cubic, CurveKind::quintic, CurveKind::rest}) {
    for (const SplineEnds ends : {SplineEnds::rest, SplineEnds::clamped}) {
      const CurveForm form{.kind = kind, .ends = ends, .profile = RestProfile::septic};
      std::vector<double> h(form.count_intervals(4));
      for (std::size_t i = 0; i < h.size(); ++i) {
        h[i] = 0.5 + 0.3 * static_cast<double>(i);
      }
      const MotionCurve curve(form, points, h);
      for (std::size_t point = 0; point < 4; ++point) {
        const double t = curve.knots_s()[form.find_knot(point, 4)];
        EXPECT_NEAR(get_value(curve, t, 0), points(0, static_cast<Eigen::Index>(point)), 1e-13)
            << curve_kind_names()[static_cast<std::size_t>(kind)] << " " << point;
      }
      EXPECT_NEAR(get_value(curve, 0, 1), 0, 1e-13);
      EXPECT_NEAR(get_value(curve, curve.duration_s(), 1), 0, 1e-12);
      const int smooth = kind == CurveKind::quintic ? 3 : 2;
      for (std::size_t knot = 1; knot + 1 < curve.knots_s().size(); ++knot) {
        for (int order = 0; order <= smooth; ++order) {
          const double t = curve.knots_s()[knot], step = 1e-9;
          // The next derivatives are below 1000, and the two times are 2e-9 apart.
          EXPECT_NEAR(get_value(curve, t - step, order), get_value(curve, t + step, order), 2e-6)
              << curve_kind_names()[static_cast<std::size_t>(kind)] << " " << knot << " " << order;
        }
      }
    }
  }
}

TEST(MotionCurve, DerivativesAndPeaksAreThoseOfDenseSamples) {
  Eigen::MatrixXd points(1, 4);
  points << 0.3, -1.1, 0.7, 0.2;
  std::vector<CurveForm> forms = {{.kind = CurveKind::cubic}, {.kind = CurveKind::quintic}};
  for (const RestProfile profile :
       {RestProfile::quintic, RestProfile::septic, RestProfile::bang_bang, RestProfile::sine}) {
    forms.push_back({.kind = CurveKind::rest, .ends = {}, .profile = profile});
  }
  for (const CurveForm& form : forms) {
    const std::vector<double> h(form.count_intervals(4), 0.8);
    const MotionCurve curve(form, points, h);
    constexpr int kSamples = 20'000;
    double jerk = 0;
    for (int order = 0; order < 4; ++order) {
      const MotionCurve::Peak peak = curve.find_peak(0, order);
      double lower = 1e9, upper = -1e9;
      for (int k = 0; k < kSamples; ++k) {
        const double dt = curve.duration_s() / kSamples, t = (k + 0.5) * dt;
        const double value = get_value(curve, t, order);
        lower = std::min(lower, value);
        upper = std::max(upper, value);
        jerk += order == 3 ? value * value * dt : 0;
      }
      const double span = peak.upper - peak.lower;
      EXPECT_LE(peak.lower, lower + 1e-12 * span) << order;
      EXPECT_GE(peak.upper, upper - 1e-12 * span) << order;
      // Half a sample beside a peak, a derivative differs by less than 1e-3 of its span.
      EXPECT_NEAR(peak.lower, lower, 1e-3 * span) << order;
      EXPECT_NEAR(peak.upper, upper, 1e-3 * span) << order;
      EXPECT_NEAR(get_value(curve, peak.upper_s, order), peak.upper,
                  (order == 3 ? 2 : 1e-9) * span)  // a jerk jumps at knots
          << order;
    }
    EXPECT_NEAR(curve.calc_jerk_integral(0) / jerk, 1, 1e-3);
  }
}

// 32 D / J and so on; joint 4 of Gasparetto's points decides, and in the second task of Fang et al.
// the speed of joint 1 for the polynomial.
TEST(LeastTime, OfPointToPointProfilesIsThePublishedOne) {
  const double d[] = {65, 15, 15, 140, 40, 95};
  const double v[] = {100, 95, 100, 150, 130, 110}, a[] = {60, 60, 75, 70, 90, 80},
               j[] = {60, 66, 85, 70, 75, 70};
  const double pi = std::numbers::pi;
  const double d2[] = {11 * pi / 15, pi / 6, pi / 6, pi / 3, 3 * pi / 4, pi / 4};
  const double v2[] = {1.8, 2, 1.5, 2, 2.5, 2}, a2[] = {4, 5, 3.5, 4, 5, 4},
               j2[] = {20, 25, 20, 20, 30, 25};
  const auto find = [](RestProfile profile, const double* ways, const double* speeds,
                       const double* accelerations, const double* jerks) {
    double time = 0;
    for (int i = 0; i < 6; ++i) {
      time = std::max(time,
                      calc_least_time_s(profile, ways[i], speeds[i], accelerations[i], jerks[i]));
    }
    return time;
  };
  EXPECT_NEAR(find(RestProfile::bang_bang, d, v, a, j), 4, 1e-12);
  EXPECT_NEAR(find(RestProfile::septic, d, v, a, j), 4.7177, 5e-5);
  EXPECT_NEAR(find(RestProfile::sine, d, v, a, j), 4.6498, 5e-5);
  EXPECT_NEAR(find(RestProfile::septic, d2, v2, a2, j2), 2.7998, 5e-5);
  double limited = 0;
  for (int i = 0; i < 6; ++i) {
    limited = std::max(limited, calc_jerk_limited_time_s(d2[i], v2[i], a2[i], j2[i]));
    EXPECT_NEAR(calc_jerk_limited_time_s(d[i], 1e9, 1e9, j[i]), std::cbrt(32 * d[i] / j[i]), 1e-12);
  }
  EXPECT_NEAR(limited, 1.9299, 5e-5);
}

// The curve of a profile has the peaks from which its least time is computed.
TEST(LeastTime, IsTheTimeInWhichTheProfileMeetsItsLimit) {
  Eigen::MatrixXd points(1, 2);
  points << 0.4, 1.9;
  for (const RestProfile profile :
       {RestProfile::quintic, RestProfile::septic, RestProfile::bang_bang, RestProfile::sine}) {
    const double limits[3][3] = {{0.7, 1e9, 1e9}, {1e9, 0.9, 1e9}, {1e9, 1e9, 2.5}};
    for (int order = 1; order <= 3; ++order) {
      const double* limit = limits[order - 1];
      const double time = calc_least_time_s(profile, 1.5, limit[0], limit[1], limit[2]);
      const MotionCurve curve({.kind = CurveKind::rest, .ends = {}, .profile = profile}, points,
                              {&time, 1});
      EXPECT_NEAR(curve.find_peak(0, order).magnitude() / limit[order - 1], 1, 1e-12)
          << rest_profile_names()[static_cast<std::size_t>(profile)] << " " << order;
    }
  }
}

TEST(MotionCurve, OfSamplesPassesTheirPositionsRatesAndAccelerations) {
  const double times[] = {0, 0.25, 0.75, 1.5};
  Eigen::MatrixXd q(1, 4), v(1, 4), a(1, 4);
  q << 0, 0.2, -0.3, 1;
  v << 0, 0.5, 0.1, 0;
  a << 0, -1, 2, 0;
  const MotionCurve curve(times, q, v, a.leftCols(3), a.rightCols(3));
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(get_value(curve, times[k], 0), q(0, k), 1e-14);
    EXPECT_NEAR(get_value(curve, times[k], 1), v(0, k), 1e-13);
    EXPECT_NEAR(get_value(curve, times[k], 2), a(0, k), 1e-12);
  }
  // Accelerations may jump between pieces.
  const MotionCurve jumping(times, q, v, a.leftCols(3), 2 * a.rightCols(3));
  EXPECT_NEAR(get_value(jumping, 0.25 - 1e-9, 2), -2, 1e-6);
  EXPECT_NEAR(get_value(jumping, 0.25 + 1e-9, 2), -1, 1e-6);
}

}  // namespace
}  // namespace armwright
