// Flexible links as chains of rigid pieces on unactuated joints, against the uniform beam: link 2 of
// De Luca and Siciliano 1991, clamped, with a payload at its end.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/decompositions.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/tracking/elasticity.hpp"
#include "swinging_arms.hpp"

namespace armwright::physics_test {
namespace {

constexpr double kBeamLength_m = 0.5, kBeamStiffness_n_m2 = 1, kBeamDensity_kg_per_m = 0.2;
constexpr double kPayload_kg = 0.1, kPayload_kg_m2 = 0.0005;

// Returns the beam as n springs EI / h at (i - 1/2) h and pieces of the length h = L / n behind
// them, the last one of h / 2. It moves in a horizontal plane, from x = 0 to L.
RobotModel make_beam(int pieces, double damping_s = 0) {
  const double h = kBeamLength_m / pieces;
  RobotModel beam;
  beam.name = "beam";
  for (int i = 0; i < pieces; ++i) {
    const bool last = i + 1 == pieces;
    const double length = last ? h / 2 : h;
    Joint joint;
    joint.name = "bend_" + std::to_string(i + 1);
    joint.origin.translation().x() = i == 0 ? h / 2 : h;
    joint.lower = -1e-3;
    joint.upper = 1e-3;
    joint.speed_limit = joint.effort_limit = std::numeric_limits<double>::infinity();
    joint.plant.set_unactuated(kBeamStiffness_n_m2 / h, damping_s * kBeamStiffness_n_m2 / h, kPi);
    beam.joints.push_back(joint);
    const double mass = kBeamDensity_kg_per_m * length;
    const Eigen::Vector3d bar = mass * length * length / 12 * Eigen::Vector3d(0.1, 1, 1);
    Link link{"piece", {mass, {length / 2, 0, 0}, bar.asDiagonal()}, {}};
    if (last) {
      const Eigen::Vector3d load = kPayload_kg_m2 * Eigen::Vector3d(1, 1, 1);
      link.inertial =
          combine(link.inertial, {kPayload_kg, {length, 0, 0}, Eigen::Matrix3d(load.asDiagonal())});
      beam.tip_pose.translation().x() = length;
    }
    beam.links.push_back(link);
  }
  return beam;
}

// Returns the mode shapes and the squares of the rates, slowest first.
Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> calc_modes(const RobotModel& beam) {
  const VectorXd rest = VectorXd::Zero(static_cast<Eigen::Index>(beam.joint_count()));
  const MatrixXd mass = make_arm<ArticulatedArm>(beam, rest).calc_mass_matrix();
  const MatrixXd stiffness =
      beam.joints[0].plant.stiffness * MatrixXd::Identity(mass.rows(), mass.cols());
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(stiffness, mass);
}

// Computed with an independent program (numpy). The beam itself has 2.17833 and 15.91451 Hz.
TEST(FlexibleLink, HasTheFrequenciesOfItsPieces) {
  struct Row {
    int pieces;
    double first_hz, second_hz, largest_step_ms;
  };
  for (const Row& row :
       {Row{2, 2.25550, 16.91, 18.8}, Row{3, 2.21164, 16.41, 7.0}, Row{4, 2.19688, 16.20, 3.0},
        Row{6, 2.18652, 16.04, 1.1}, Row{8, 2.18293, 15.99, 0}}) {
    SCOPED_TRACE(row.pieces);
    const RobotModel beam = make_beam(row.pieces);
    const VectorXd squares = calc_modes(beam).eigenvalues();
    EXPECT_NEAR(std::sqrt(squares[0]) / (2 * kPi), row.first_hz, 0.6e-5);
    EXPECT_NEAR(std::sqrt(squares[1]) / (2 * kPi), row.second_hz, 0.6e-2);
    const auto fastest = find_fastest_mode(beam);
    ASSERT_TRUE(fastest);
    // The postures that it looks at are bent by up to 1e-3 rad.
    EXPECT_NEAR(fastest->rate_rad_per_s, std::sqrt(squares[row.pieces - 1]),
                1e-3 * fastest->rate_rad_per_s);
    if (row.largest_step_ms > 0) {
      EXPECT_NEAR(2000 / fastest->rate_rad_per_s, row.largest_step_ms, 0.06);
    }
  }
}

// The damping is implicit, so it does not limit the step.
TEST(FlexibleLink, DampingDoesNotLimitTheStep) {
  EXPECT_EQ(find_fastest_mode(make_beam(3))->rate_rad_per_s,
            find_fastest_mode(make_beam(3, 100))->rate_rad_per_s);
}

template <class Arm>
class BendingChain : public testing::Test {};
TYPED_TEST_SUITE(BendingChain, ArmTypes, ArmNames);

// A force F across the tip bends spring i by F (L - x_i) h / EI. The tip is then off by the beam's
// F L^3 / (3 EI) times 1 - 1 / (4 n^2), and the bent chain stays at rest.
TYPED_TEST(BendingChain, BendsStatically) {
  constexpr double kForce_n = 1e-4;
  for (const int pieces : {2, 3, 8}) {
    const RobotModel beam = make_beam(pieces);
    const double h = kBeamLength_m / pieces;
    VectorXd moment(pieces);
    for (int i = 0; i < pieces; ++i) {
      moment[i] = kForce_n * (kBeamLength_m - (i + 0.5) * h);
    }
    const VectorXd bent = moment * h / kBeamStiffness_n_m2;
    DrivenArm<TypeParam> chain(beam, bent, 1e-4);
    const double exact_m = kForce_n * std::pow(kBeamLength_m, 3) / (3 * kBeamStiffness_n_m2);
    // Angles up to 2.5e-5 rad: sines and the force's direction differ by their squares. ODE's
    // places are in double, off by 1e-16 m of 4e-6.
    const double expected_m = exact_m * (1 - 1 / (4.0 * pieces * pieces));
    EXPECT_NEAR(chain.arm().tip_position_m().y(), expected_m, 1e-8 * exact_m);
    for (int k = 0; k < 10; ++k) {
      chain.step(moment);
    }
    EXPECT_NEAR(chain.arm().tip_position_m().y(), expected_m, 1e-6 * exact_m);
  }
}

// The chain of three pieces swings freely in its first shape, 1 mm at the tip. Semi-implicit Euler
// makes the rate w h^2 w^2 / 24 = 8e-6 w too high; the bend of 2e-3 rad changes it by its square.
TYPED_TEST(BendingChain, SwingsAtItsFrequency) {
  constexpr double kStep_s = 0.001;
  const RobotModel beam = make_beam(3);
  const auto modes = calc_modes(beam);
  const double rate = std::sqrt(modes.eigenvalues()[0]);
  VectorXd shape = modes.eigenvectors().col(0);
  double tip_m = 0;
  for (int i = 0; i < 3; ++i) {
    tip_m += shape[i] * kBeamLength_m * (1 - (i + 0.5) / 3);
  }
  DrivenArm<TypeParam> chain(beam, shape * (1e-3 / tip_m), kStep_s);
  double before_m = 1e-3;
  double first_s = 0;
  double last_s = 0;
  double most_m = 0;
  int crossings = -1;
  for (int k = 0; k < 5000; ++k) {
    chain.step(VectorXd::Zero(3));
    const double now_m = chain.arm().tip_position_m().y();
    if (before_m < 0 && now_m >= 0) {
      last_s = kStep_s * (k + 1 - now_m / (now_m - before_m));
      first_s = ++crossings == 0 ? last_s : first_s;
    }
    most_m = std::max(most_m, k > 4000 ? std::abs(now_m) : 0);
    before_m = now_m;
  }
  ASSERT_EQ(crossings, 10);
  const double measured = crossings * 2 * kPi / (last_s - first_s);
  EXPECT_NEAR(measured, rate * (1 + rate * rate * kStep_s * kStep_s / 24), 1e-5 * rate);
  EXPECT_NEAR(most_m, 1e-3, 0.02e-3);  // without damping it goes on
}

// Damping z = beta k lets every shape decay with w^2 beta / 2.
TYPED_TEST(BendingChain, DecaysByItsDamping) {
  constexpr double kStep_s = 0.001, kBeta_s = 0.004;
  const RobotModel beam = make_beam(2, kBeta_s);
  const auto modes = calc_modes(beam);
  const double square = modes.eigenvalues()[0];
  DrivenArm<TypeParam> chain(beam, modes.eigenvectors().col(0) * 1e-3, kStep_s);
  const double start_m = chain.arm().tip_position_m().y();
  double most_m = 0;
  for (int k = 0; k < 3000; ++k) {
    chain.step(VectorXd::Zero(2));
    most_m = std::max(most_m, k >= 2000 ? std::abs(chain.arm().tip_position_m().y()) : 0);
  }
  // The first peak after 2 s, within half a period of 0.44 s.
  const double decay = square * kBeta_s / 2;
  EXPECT_LT(most_m, std::abs(start_m) * std::exp(-1.98 * decay));
  EXPECT_GT(most_m, std::abs(start_m) * std::exp(-2.24 * decay));
}

}  // namespace
}  // namespace armwright::physics_test
