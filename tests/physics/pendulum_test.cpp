// Compares one link on one hinge with the closed forms of the compound pendulum.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "convergence.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

// The numbers that the closed forms need, of a link on an axis of any inclination.
struct Pendulum {
  explicit Pendulum(const Vector3d& axis) : model(make_pendulum(axis)) {
    const Vector3d a = model.joints[0].axis;
    const Inertial& body = model.links[0].inertial;
    const Vector3d gravity(0, 0, -kGravity_m_per_s2);
    const Vector3d lever = body.com_m - a * a.dot(body.com_m);
    const Vector3d pull = gravity - a * a.dot(gravity);  // the part of gravity that turns it
    lever_m = lever.norm();
    pull_m_per_s2 = pull.norm();
    inertia_kg_m2 = a.dot(body.inertia_kg_m2 * a) + body.mass_kg * lever_m * lever_m;  // Steiner
    rest_rad = std::atan2(a.dot(lever.cross(pull)), lever.dot(pull));
    torque_n_m = body.mass_kg * pull_m_per_s2 * lever_m;
  }
  double calc_frequency_rad_per_s() const { return std::sqrt(torque_n_m / inertia_kg_m2); }
  // T = 4 sqrt(J / m g l) K(sin(A / 2)) and K = pi / (2 AGM(1, cos(A / 2))), A the amplitude.
  double calc_period_s(double amplitude_rad) const {
    double a = 1, b = std::cos(amplitude_rad / 2);
    while (a - b > 1e-15) {
      const double mean = (a + b) / 2;
      b = std::sqrt(a * b);
      a = mean;
    }
    return 2 * kPi / calc_frequency_rad_per_s() / a;
  }

  RobotModel model;
  double lever_m, pull_m_per_s2, inertia_kg_m2, torque_n_m;
  double rest_rad;  // joint angle at which it hangs
};

// Returns the time from the first to the third pass through the lowest point, interpolated linearly
// between steps.
template <class Arm>
double measure_period_s(const Pendulum& pendulum, double amplitude_rad, double h_s) {
  const VectorXd start = VectorXd::Constant(1, pendulum.rest_rad + amplitude_rad);
  Arm arm = make_arm<Arm>(pendulum.model, start);
  std::vector<double> passes_s;
  double before = amplitude_rad;
  for (int k = 1; passes_s.size() < 3 && k * h_s < 10; ++k) {
    step(arm, VectorXd::Zero(1), h_s);
    const double angle = std::remainder(read_positions(arm, 1)[0] - pendulum.rest_rad, 2 * kPi);
    if (angle * before < 0 && std::abs(angle) < 1.5) {  // not the jump from pi to -pi
      passes_s.push_back(h_s * (k - angle / (angle - before)));
    }
    before = angle;
  }
  EXPECT_EQ(passes_s.size(), 3u) << "it does not swing";
  return passes_s.size() == 3 ? passes_s[2] - passes_s[0] : 0;
}

const std::vector<Vector3d> kAxes{{0, 1, 0}, {-0.6, 0.8, 0}, {0.5, 0.8, 0.4}};

template <class Arm>
class PendulumOnAxis : public testing::Test {};
TYPED_TEST_SUITE(PendulumOnAxis, ArmTypes, ArmNames);

// Semi-implicit Euler turns a harmonic oscillator of frequency w into one of frequency w' with
// cos(w' h) = 1 - (w h)^2 / 2, so its period is too short by (w h)^2 / 24, 8e-5 here. The rest
// (interpolation of the passes, loss of amplitude, A^2 terms of the error) is below a tenth of
// that.
TYPED_TEST(PendulumOnAxis, SmallSwingsHaveTheClosedFormPeriodUpToTheIntegratorsOwnError) {
  for (const Vector3d& axis : kAxes) {
    SCOPED_TRACE(testing::Message() << "axis " << axis.transpose());
    const Pendulum pendulum(axis);
    const double amplitude_rad = 0.02;
    for (const double h_s : {0.01, 0.005, 0.0025}) {
      const double error = measure_period_s<TypeParam>(pendulum, amplitude_rad, h_s) /
                               pendulum.calc_period_s(amplitude_rad) -
                           1;
      const double expected = -std::pow(pendulum.calc_frequency_rad_per_s() * h_s, 2) / 24;
      EXPECT_NEAR(error, expected, -0.1 * expected) << "step " << h_s << " s";
    }
  }
}

// Large swings, whose period converges with the arm's own order.
TYPED_TEST(PendulumOnAxis, LargeSwingsConvergeToTheClosedFormPeriod) {
  for (const Vector3d& axis : kAxes) {
    SCOPED_TRACE(testing::Message() << "axis " << axis.transpose());
    const Pendulum pendulum(axis);
    for (const double amplitude_rad : {2.1, 2.6}) {
      const double period_s = pendulum.calc_period_s(amplitude_rad);
      const Limit limit = extrapolate(
          [&](int steps_per_s) {
            return VectorXd::Constant(
                1, measure_period_s<TypeParam>(pendulum, amplitude_rad, 1.0 / steps_per_s));
          },
          1600, ArmTraits<TypeParam>::kPeriodOrder);
      EXPECT_NEAR(limit.order, ArmTraits<TypeParam>::kPeriodOrder, kOrderTolerance)
          << "amplitude " << amplitude_rad;
      EXPECT_LT(limit.error, 3e-4 * period_s);  // or the next check is weak
      // 1e-11: rounding, of passes found between steps.
      EXPECT_NEAR(limit.value[0], period_s, limit.error + 1e-11 * period_s)
          << "amplitude " << amplitude_rad;
      // The first-order term itself at the finest step, relative: about the fastest turn per step.
      const double fastest_rad_per_s =
          2 * pendulum.calc_frequency_rad_per_s() * std::sin(amplitude_rad / 2);
      EXPECT_NEAR(limit.finest[0], period_s, fastest_rad_per_s / 6400 * period_s)
          << "amplitude " << amplitude_rad;
    }
  }
}

// Released at rest, the link has the rate h m g l sin(from rest) / J after the first step, up to
// rounding: without velocity the integrator has no error. With the angle phi between lever and
// horizontal, the acceleration is m g l cos(phi) / J.
TYPED_TEST(PendulumOnAxis, FallsWithTheAccelerationOfTheHandFormula) {
  for (const Vector3d& axis : kAxes) {
    SCOPED_TRACE(testing::Message() << "axis " << axis.transpose());
    const Pendulum pendulum(axis);
    const double h_s = 0.01;
    for (const double phi_rad : {-1.2, -0.4, 0.3, 1.1, 1.5}) {
      const double from_rest_rad = kPi / 2 - phi_rad;
      auto arm = make_arm<TypeParam>(pendulum.model,
                                     VectorXd::Constant(1, pendulum.rest_rad + from_rest_rad));
      step(arm, VectorXd::Zero(1), h_s);
      const double acceleration =
          -pendulum.torque_n_m * std::cos(phi_rad) / pendulum.inertia_kg_m2;  // back to the bottom
      EXPECT_NEAR(read_rates(arm, 1)[0] / h_s, acceleration, 1e-10) << "phi " << phi_rad;
    }
  }
}

// A large effort and gravity add up; the effort acts about the hinge's axis.
TYPED_TEST(PendulumOnAxis, AnEffortAddsToGravity) {
  for (const Vector3d& axis : kAxes) {
    SCOPED_TRACE(testing::Message() << "axis " << axis.transpose());
    const Pendulum pendulum(axis);
    const double h_s = 0.01, from_rest_rad = 0.8;
    for (const double effort_n_m : {-31.7, -2.3, 4.1, 55.5}) {
      auto arm = make_arm<TypeParam>(pendulum.model,
                                     VectorXd::Constant(1, pendulum.rest_rad + from_rest_rad));
      step(arm, VectorXd::Constant(1, effort_n_m), h_s);
      const double acceleration =
          (effort_n_m - pendulum.torque_n_m * std::sin(from_rest_rad)) / pendulum.inertia_kg_m2;
      EXPECT_NEAR(read_rates(arm, 1)[0] / h_s, acceleration, 1e-10) << "effort " << effort_n_m;
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
