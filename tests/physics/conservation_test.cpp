// Energy, work and angular momentum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chain_oracle.hpp"
#include "convergence.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

const VectorXd kTwoAngles = (VectorXd(2) << 0.7, -1.1).finished();
const VectorXd kThreeAngles = (VectorXd(3) << 0.6, -0.9, 1.3).finished();

double calc_energy_j(const OdeArm& arm) {
  return arm.calc_kinetic_energy_j() + arm.calc_potential_energy_j();
}

struct Arm {
  const char* name;
  RobotModel model;
  VectorXd start_rad;
};
void PrintTo(const Arm& arm, std::ostream* out) {
  *out << arm.name;
}
Arm make_two_links() {
  return {"two_links", make_planar_arm({0, 1, 0}), kTwoAngles};
}
Arm make_three_links() {
  return {"three_links", make_skew_arm(), kThreeAngles};
}

class SwingingArm : public testing::TestWithParam<Arm> {};
INSTANTIATE_TEST_SUITE_P(Arms, SwingingArm, testing::Values(make_two_links(), make_three_links()),
                         [](const auto& arm) { return std::string(arm.param.name); });

// From rest the first step's energies are exact, V = sum of m g z and T = qd' M(q) qd / 2, but for
// rates measured along axes that have turned by up to h |qd|: the square of that, relative.
TEST_P(SwingingArm, EnergiesAreThoseOfTheEquationsOfMotion) {
  const Arm& a = GetParam();
  const auto joints = static_cast<std::size_t>(a.start_rad.size());
  const ChainOracle oracle(a.model, kGravity_m_per_s2);
  OdeArm arm = make_arm(a.model, a.start_rad);
  const VectorXd rest = VectorXd::Zero(a.start_rad.size());
  EXPECT_EQ(arm.calc_kinetic_energy_j(), 0);
  EXPECT_NEAR(arm.calc_potential_energy_j(), oracle.calc(a.start_rad, rest).potential_energy_j,
              1e-12 * 100);  // rounding of some 100 J
  step(arm, VectorXd::Constant(a.start_rad.size(), 7.7), 0.01);
  const VectorXd rates = read_rates(arm, joints);
  const double expected_j = oracle.calc_kinetic_energy_j(a.start_rad, rates);
  EXPECT_GT(expected_j, 0.01);
  EXPECT_NEAR(arm.calc_kinetic_energy_j(), expected_j,
              std::pow(0.01 * rates.cwiseAbs().sum(), 2) * expected_j);
}

// The largest deviation from the start's energy over a second of free swinging.
double measure_drift_j(const Arm& a, int steps) {
  OdeArm arm = make_arm(a.model, a.start_rad);
  const double start_j = calc_energy_j(arm);
  double drift_j = 0, fastest_j = 0;
  for (int k = 0; k < steps; ++k) {
    step(arm, VectorXd::Zero(a.start_rad.size()), 1.0 / steps);
    drift_j = std::max(drift_j, std::abs(calc_energy_j(arm) - start_j));
    fastest_j = std::max(fastest_j, arm.calc_kinetic_energy_j());
  }
  EXPECT_GT(fastest_j, 5) << "hardly moves";
  return drift_j;
}

TEST_P(SwingingArm, TheEnergyDriftShrinksInProportionToTheStep) {
  const double coarse_j = measure_drift_j(GetParam(), 800);
  const double middle_j = measure_drift_j(GetParam(), 1600);
  const double fine_j = measure_drift_j(GetParam(), 3200);
  EXPECT_NEAR(std::log2(coarse_j / middle_j), 1, kOrderTolerance);
  EXPECT_NEAR(std::log2(middle_j / fine_j), 1, kOrderTolerance);
  // Semi-implicit Euler errs by about h |dT/dt| / 2, with some 100 J/s here; ODE's is of that size.
  EXPECT_LT(fine_j, 100.0 / 3200);
}

// Constant efforts: the work is the sum of effort x rotation, without any integral to approximate;
// what remains of (energy change - work) is the integrator's, first order.
TEST_P(SwingingArm, WorkInIsEnergyChange) {
  const Arm& a = GetParam();
  const auto joints = static_cast<std::size_t>(a.start_rad.size());
  const VectorXd tau = VectorXd::LinSpaced(a.start_rad.size(), 4.0, -1.5);
  double work_j = 0;
  const auto simulate = [&](int steps) {
    OdeArm arm = make_arm(a.model, a.start_rad);
    const double start_j = calc_energy_j(arm);
    VectorXd q = a.start_rad;
    for (int k = 0; k < steps; ++k) {
      step(arm, tau, 1.0 / steps);
      q += wrap_angles(read_angles(arm, joints) - q);
    }
    work_j = tau.dot(q - a.start_rad);
    return VectorXd::Constant(1, calc_energy_j(arm) - start_j - work_j);
  };
  const Limit imbalance_j = extrapolate(simulate, 1600);
  EXPECT_GT(std::abs(work_j), 5);
  EXPECT_NEAR(imbalance_j.order, 1, kOrderTolerance);
  EXPECT_LT(imbalance_j.error, 1e-3 * std::abs(work_j));  // or the next line would say little
  EXPECT_LT(std::abs(imbalance_j.value[0]), imbalance_j.error);
}

// About a vertical first axis neither gravity nor efforts in the other joints have a moment: the
// angular momentum there, the first row of M(q) qd, is the impulse of the first effort.
class Turntable : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Gravity, Turntable, testing::Values(0.0, kGravity_m_per_s2));

// The largest deviation from the impulse over a second; the first effort acts for a quarter of it.
double measure_momentum_error_n_m_s(double gravity, double first_effort_n_m, int steps) {
  const RobotModel model = make_turntable_arm();
  const ChainOracle oracle(model, gravity);
  PhysicsSettings physics;
  physics.gravity_m_per_s2 = gravity;
  OdeArm arm = make_arm(model, kThreeAngles, physics);
  double impulse_n_m_s = 0, error = 0;
  VectorXd turned = kThreeAngles;
  for (int k = 0; k < steps; ++k) {
    const double t_s = static_cast<double>(k) / steps;
    VectorXd tau(3);
    tau << (t_s < 0.25 ? first_effort_n_m : 0), 4 * std::sin(5 * t_s + 0.3),
        -1.1 * std::cos(3 * t_s);
    step(arm, tau, 1.0 / steps);
    impulse_n_m_s += tau[0] / steps;
    const VectorXd q = read_angles(arm, 3), qd = read_rates(arm, 3);
    turned += wrap_angles(q - turned);
    error = std::max(error, std::abs((oracle.calc(q, qd).mass * qd)[0] - impulse_n_m_s));
  }
  EXPECT_GT((turned - kThreeAngles).cwiseAbs().minCoeff(), 0.1) << "hardly moves";
  return error;
}

// Rates belong to the positions before the step, the mass matrix to those after it: the difference
// is of first order, of the size of the momentum (3 N m s) times the turn in a step (rates up to
// 10 rad/s).
TEST_P(Turntable, AngularMomentumAboutItsAxisIsTheImpulse) {
  for (const double effort_n_m : {0.0, 11.0}) {
    const double coarse = measure_momentum_error_n_m_s(GetParam(), effort_n_m, 800);
    const double fine = measure_momentum_error_n_m_s(GetParam(), effort_n_m, 1600);
    EXPECT_LT(fine, 3 * 10.0 / 1600) << "effort " << effort_n_m;
    EXPECT_NEAR(std::log2(coarse / fine), 1, kOrderTolerance) << "effort " << effort_n_m;
  }
}

}  // namespace
}  // namespace armwright::physics_test
