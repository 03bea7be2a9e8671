// Compares chains of two and three links with equations of motion written here.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "chain_oracle.hpp"
#include "planes.hpp"
#include "solving.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

// The textbook's planar two-link manipulator (e.g. Spong, Hutchinson, Vidyasagar, Robot Modeling
// and Control, 2006, section 7.3), with centres of mass anywhere. Plane coordinates (u, v) with
// u x v along the joints' axis.
class PlanarManipulator {
 public:
  PlanarManipulator(const RobotModel& model, const Vector3d& u, const Vector3d& v, double gravity) {
    const auto project = [&](const Vector3d& p) { return Vector2d(p.dot(u), p.dot(v)); };
    const Vector3d axis = u.cross(v);
    const Inertial &a = model.links[0].inertial, &b = model.links[1].inertial;
    m1_ = a.mass_kg;
    m2_ = b.mass_kg;
    i1_ = axis.dot(a.inertia_kg_m2 * axis);
    i2_ = axis.dot(b.inertia_kg_m2 * axis);
    c1_ = project(a.com_m);
    c2_ = project(b.com_m);
    d_ = project(model.joints[1].origin.translation());
    gravity_ = project(Vector3d(0, 0, -gravity));
  }

  Matrix2d calc_mass(const VectorXd& q) const {
    const double coupling = m2_ * d_.dot(turn(q[1], c2_));
    const double m22 = i2_ + m2_ * c2_.squaredNorm();
    const double m11 = i1_ + m1_ * c1_.squaredNorm() + m2_ * d_.squaredNorm() + m22 + 2 * coupling;
    Matrix2d m;
    m << m11, m22 + coupling, m22 + coupling, m22;
    return m;
  }

  Vector2d calc_bias(const VectorXd& q, const VectorXd& qd) const {
    const double s = m2_ * d_.dot(turn(q[1], turn_left(c2_)));  // d coupling / d q2
    const Vector2d coriolis(s * (2 * qd[0] * qd[1] + qd[1] * qd[1]), -s * qd[0] * qd[0]);
    const double g2 = -m2_ * gravity_.dot(turn(q[0] + q[1], turn_left(c2_)));
    const double g1 = -gravity_.dot(turn(q[0], turn_left(m1_ * c1_ + m2_ * d_))) + g2;
    return coriolis + Vector2d(g1, g2);
  }

  VectorXd calc_acceleration(const VectorXd& q, const VectorXd& qd, const VectorXd& tau) const {
    return calc_mass(q).inverse() * (Vector2d(tau) - calc_bias(q, qd));
  }

 private:
  double m1_, m2_, i1_, i2_;
  Vector2d c1_, c2_, d_, gravity_;
};

const VectorXd kTwoPositions = make_vector({0.7, -1.1});
const VectorXd kTwoEfforts_n_m = make_vector({9, -2.5});
const VectorXd kThreePositions = make_vector({0.6, -0.9, 1.3});
const VectorXd kThreeEfforts_n_m = make_vector({4, -3, 0.7});

template <class Arm>
class TwoLinkArm : public testing::Test {};
TYPED_TEST_SUITE(TwoLinkArm, ArmTypes, ArmNames);

TYPED_TEST(TwoLinkArm, FollowsTheTextbookEquations) {
  for (const Plane& plane : kPlanes) {
    SCOPED_TRACE(plane.name);
    const RobotModel model = make_planar_arm(plane.u.cross(plane.v));
    const PlanarManipulator textbook(model, plane.u, plane.v, kGravity_m_per_s2);
    expect_solves<TypeParam>(
        model,
        [&](double t_s, const VectorXd& q, const VectorXd& qd) {
          return textbook.calc_acceleration(q, qd, calc_drive(kTwoEfforts_n_m, t_s));
        },
        kTwoPositions, kTwoEfforts_n_m);
  }
}

// Checks the oracle of the spatial arms; only rounding errors are allowed.
TEST(TwoLinks, TheJacobianEquationsAgreeWithTheTextbooks) {
  for (const Plane& plane : kPlanes) {
    SCOPED_TRACE(plane.name);
    const RobotModel model = make_planar_arm(plane.u.cross(plane.v));
    const PlanarManipulator textbook(model, plane.u, plane.v, kGravity_m_per_s2);
    const ChainOracle oracle(model, kGravity_m_per_s2);
    for (int i = 1; i < 20; ++i) {
      const VectorXd q = make_vector({0.9 * i, -1.7 * i}), qd = make_vector({3.1 - i, 0.4 * i});
      const ChainOracle::Equations equations = oracle.calc(q, qd);
      EXPECT_LT((equations.mass - textbook.calc_mass(q)).norm(), 1e-12);
      EXPECT_LT((equations.bias - textbook.calc_bias(q, qd)).norm(), 1e-10);
    }
  }
}

// Without efforts, RK4 conserves the oracle's energy up to its own error. The equations of the skew
// arm, including gyroscopic terms, are therefore consistent with its energy.
TEST(ThreeLinks, TheJacobianEquationsKeepTheirEnergy) {
  const RobotModel model = make_skew_arm();
  const ChainOracle oracle(model, kGravity_m_per_s2);
  const State start{kThreePositions, make_vector({1.1, -0.7, 2.3})};
  const State end = integrate_rk4(
      [&](double, const VectorXd& q, const VectorXd& qd) {
        return oracle.calc_acceleration(q, qd, VectorXd::Zero(3));
      },
      start, kTruthSteps, 1.0 / kTruthSteps);
  const auto energy = [&](const State& s) {
    return oracle.calc_kinetic_energy_j(s.q, s.qd) + oracle.calc(s.q, s.qd).potential_energy_j;
  };
  ASSERT_GT((end.q - start.q).norm(), 1);
  EXPECT_NEAR(energy(end), energy(start), 1e-8);
}

template <class Arm>
class SkewArm : public testing::Test {};
TYPED_TEST_SUITE(SkewArm, ArmTypes, ArmNames);

TYPED_TEST(SkewArm, FollowsTheEquationsOfMotion) {
  const RobotModel model = make_skew_arm();
  const ChainOracle oracle(model, kGravity_m_per_s2);
  expect_solves<TypeParam>(model, make_driven_acceleration(oracle, kThreeEfforts_n_m),
                           kThreePositions, kThreeEfforts_n_m);
}

TYPED_TEST(SkewArm, TheFirstStepHasTheAccelerationsOfTheEquationsOfMotion) {
  for (const VectorXd& tau : {make_vector({0, 0, 0}), make_vector({21, -13, 4.5})}) {
    expect_first_step<TypeParam>(make_skew_arm(), kThreePositions, tau, 0.002);
  }
}

}  // namespace
}  // namespace armwright::physics_test
