// Energy, work and angular momentum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "chain_oracle.hpp"
#include "convergence.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

const VectorXd kTwoAngles = make_vector({0.7, -1.1});
const VectorXd kThreeAngles = make_vector({0.6, -0.9, 1.3});

template <class Arm>
double calc_energy_j(const Arm& arm) {
  return arm.calc_kinetic_energy_j() + arm.calc_potential_energy_j();
}

struct SomeArm {
  const char* name;
  RobotModel model;
  VectorXd start;
};
const std::vector<SomeArm> kArms{{"two links", make_planar_arm({0, 1, 0}), kTwoAngles},
                                 {"three links", make_skew_arm(), kThreeAngles},
                                 {"rpr", make_mixed_arm("rpr"), kThreeAngles},
                                 {"prp", make_mixed_arm("prp"), kThreeAngles},
                                 {"rrp", make_mixed_arm("rrp"), kThreeAngles}};

template <class Arm>
class SwingingArm : public testing::Test {};
TYPED_TEST_SUITE(SwingingArm, ArmTypes, ArmNames);

// From rest, the energies after the first step are exact, V = sum of m g z and T = qd' M(q) qd / 2,
// except for the error of the rates, which counts twice in their square.
TYPED_TEST(SwingingArm, EnergiesAreThoseOfTheEquationsOfMotion) {
  for (const SomeArm& a : kArms) {
    SCOPED_TRACE(a.name);
    const ChainOracle oracle(a.model, kGravity_m_per_s2);
    auto arm = make_arm<TypeParam>(a.model, a.start);
    const VectorXd rest = VectorXd::Zero(a.start.size());
    EXPECT_EQ(arm.calc_kinetic_energy_j(), 0);
    EXPECT_NEAR(arm.calc_potential_energy_j(), oracle.calc(a.start, rest).potential_energy_j,
                1e-12 * 100);  // rounding of some 100 J
    step(arm, VectorXd::Constant(a.start.size(), 7.7), 0.01);
    const VectorXd rates = read_rates(arm, a.model.joint_count());
    const VectorXd after = read_positions(arm, a.model.joint_count());
    const double expected_j =
        oracle.calc_kinetic_energy_j(ArmTraits<TypeParam>::select_posture(a.start, after), rates);
    EXPECT_GT(expected_j, 0.005);
    const double rate_error = ArmTraits<TypeParam>::calc_rate_error(
        calc_turn_rad(a.model, rates, 0.01), has_slider(a.model));
    EXPECT_NEAR(arm.calc_kinetic_energy_j(), expected_j, (2 * rate_error + 1e-12) * expected_j);
  }
}

// Returns the largest deviation from the initial energy over a second of free motion.
template <class Arm>
double measure_drift_j(const SomeArm& a, int steps) {
  Arm arm = make_arm<Arm>(a.model, a.start);
  const double start_j = calc_energy_j(arm);
  double drift_j = 0, fastest_j = 0;
  for (int k = 0; k < steps; ++k) {
    step(arm, VectorXd::Zero(a.start.size()), 1.0 / steps);
    drift_j = std::max(drift_j, std::abs(calc_energy_j(arm) - start_j));
    fastest_j = std::max(fastest_j, arm.calc_kinetic_energy_j());
  }
  EXPECT_GT(fastest_j, 5) << "hardly moves";
  return drift_j;
}

TYPED_TEST(SwingingArm, TheEnergyDriftShrinksInProportionToTheStep) {
  for (const SomeArm& a : kArms) {
    SCOPED_TRACE(a.name);
    const double coarse_j = measure_drift_j<TypeParam>(a, 800);
    const double middle_j = measure_drift_j<TypeParam>(a, 1600);
    const double fine_j = measure_drift_j<TypeParam>(a, 3200);
    EXPECT_NEAR(std::log2(coarse_j / middle_j), 1, kOrderTolerance);
    EXPECT_NEAR(std::log2(middle_j / fine_j), 1, kOrderTolerance);
    // The error of semi-implicit Euler is about h |dT/dt| / 2. |dT/dt| is some 100 J/s for a
    // swinging arm and up to 1 kJ/s for one that falls along its rail. ODE's error has the same
    // size.
    EXPECT_LT(fine_j, (has_slider(a.model) ? 1000.0 : 100.0) / 3200);
  }
}

// With constant efforts, the work is exactly the sum of effort x motion. The difference between
// energy change and work is therefore the integrator's error, of first order.
TYPED_TEST(SwingingArm, WorkInIsEnergyChange) {
  for (const SomeArm& a : kArms) {
    SCOPED_TRACE(a.name);
    const VectorXd tau = VectorXd::LinSpaced(a.start.size(), 4.0, -1.5);
    double work_j = 0;
    const auto simulate = [&](int steps) {
      auto arm = make_arm<TypeParam>(a.model, a.start);
      const double start_j = calc_energy_j(arm);
      VectorXd q = a.start;
      for (int k = 0; k < steps; ++k) {
        step(arm, tau, 1.0 / steps);
        q += calc_motion(a.model, q, read_positions(arm, a.model.joint_count()));
      }
      work_j = tau.dot(q - a.start);
      return VectorXd::Constant(1, calc_energy_j(arm) - start_j - work_j);
    };
    const Limit imbalance_j = extrapolate(simulate, 1600);
    EXPECT_GT(std::abs(work_j), 5);
    EXPECT_NEAR(imbalance_j.order, 1, kOrderTolerance);
    EXPECT_LT(imbalance_j.error, 1e-3 * std::abs(work_j));  // or the next check is weak
    EXPECT_LT(std::abs(imbalance_j.value[0]), imbalance_j.error);
  }
}

// Gravity and the efforts of the other joints have no moment about a vertical first axis. The
// angular momentum about it, the first row of M(q) qd, is therefore the impulse of the first
// effort. The same holds for the momentum along a level first rail.
struct MomentumCase {
  const char* name;
  RobotModel model;
  VectorXd efforts;
};
std::vector<MomentumCase> make_momentum_cases() {
  std::vector<MomentumCase> cases{
      {"turntable", make_turntable_arm(), make_vector({11, 4, -1.1})},
      {"turntable with a slider", make_mixed_arm("rpr"), make_vector({11, 25, -1.1})},
      {"level rail", make_mixed_arm("prr"), make_vector({40, 9, -3.1})}};
  cases[1].model.joints[0].axis = Vector3d::UnitZ();
  cases[2].model.joints[0].axis = Vector3d(0.6, -0.8, 0);
  return cases;
}

template <class Arm>
class Momentum : public testing::Test {};
TYPED_TEST_SUITE(Momentum, ArmTypes, ArmNames);

// Returns the largest deviation from the impulse over a second. The first effort acts for a quarter
// of that time.
template <class Arm>
double measure_momentum_error(const MomentumCase& a, double gravity, bool pushed, int steps) {
  const ChainOracle oracle(a.model, gravity);
  PhysicsSettings physics;
  physics.gravity_m_per_s2 = gravity;
  Arm arm = make_arm<Arm>(a.model, kThreeAngles, physics);
  double impulse = 0, error = 0;
  VectorXd moved = kThreeAngles, farthest = VectorXd::Zero(3);
  for (int k = 0; k < steps; ++k) {
    const double t_s = static_cast<double>(k) / steps;
    const VectorXd tau =
        make_vector({t_s < 0.25 && pushed ? a.efforts[0] : 0,
                     a.efforts[1] * std::sin(5 * t_s + 0.3), a.efforts[2] * std::cos(3 * t_s)});
    step(arm, tau, 1.0 / steps);
    impulse += tau[0] / steps;
    const VectorXd q = read_positions(arm, 3), qd = read_rates(arm, 3);
    moved += calc_motion(a.model, moved, q);
    farthest = farthest.cwiseMax((moved - kThreeAngles).cwiseAbs());
    error = std::max(error, std::abs((oracle.calc(q, qd).mass * qd)[0] - impulse));
  }
  EXPECT_GT(farthest.minCoeff(), 0.1) << "hardly moves";
  return error;
}

// Rates and positions after a step belong to different instants. The difference is of first order:
// the momentum (6 N m s of the turning arms, 10 N s along the rail, 30 N m s with a mass that
// slides far out) times the turn per step (rates up to 10 rad/s).
TYPED_TEST(Momentum, AlongTheFirstJointIsTheImpulse) {
  for (const MomentumCase& a : make_momentum_cases()) {
    for (const double gravity : {0.0, kGravity_m_per_s2}) {
      for (const bool pushed : {false, true}) {
        SCOPED_TRACE(testing::Message()
                     << a.name << ", gravity " << gravity << (pushed ? ", pushed" : ""));
        const double coarse = measure_momentum_error<TypeParam>(a, gravity, pushed, 800);
        const double fine = measure_momentum_error<TypeParam>(a, gravity, pushed, 1600);
        const double size = has_slider(a.model) ? 30 : 3;
        EXPECT_LT(fine, ArmTraits<TypeParam>::kMomentumError * size * 10.0 / 1600);
        EXPECT_NEAR(std::log2(coarse / fine), 1, kOrderTolerance);
      }
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
