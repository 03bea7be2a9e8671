// Prismatic joints: one compared with the closed forms of free fall, two mechanisms with a hinge
// with the textbook's equations, and chains of any kind with the equations from Jacobians.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "chain_oracle.hpp"
#include "planes.hpp"
#include "solving.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

const std::vector<Vector3d> kRails{{0, 0, 1}, {-0.6, 0.8, 0.3}, {0.5, 0.8, -0.4}};

template <class Arm>
class Slider : public testing::Test {};
TYPED_TEST_SUITE(Slider, ArmTypes, ArmNames);

// With the acceleration a = F / m - g . axis, semi-implicit Euler has the rate k h a and the
// position a h^2 k (k + 1) / 2 after k steps. Nothing turns, so the only error is rounding.
TYPED_TEST(Slider, FallsAlongItsAxis) {
  for (const Vector3d& rail : kRails) {
    for (const double force_n : {0.0, -21.5, 44.0}) {
      const RobotModel model = make_slider(rail);
      const double acceleration =
          force_n / kFirstBody.mass_kg - kGravity_m_per_s2 * model.joints[0].axis.z();
      auto arm = make_arm<TypeParam>(model, make_vector({0.37}));
      const Vector3d com_m = arm.com_position_m(0), tip_m = arm.tip_position_m();
      const double h_s = 0.01;
      for (int k = 1; k <= 200; ++k) {
        step(arm, make_vector({force_n}), h_s);
        const double moved_m = acceleration * h_s * h_s * k * (k + 1) / 2;
        ASSERT_NEAR(read_rates(arm, 1)[0], k * h_s * acceleration, 1e-11) << "step " << k;
        ASSERT_NEAR(read_positions(arm, 1)[0], 0.37 + moved_m, 1e-11) << "step " << k;
        const Vector3d way_m = moved_m * model.joints[0].axis;
        ASSERT_LT((arm.com_position_m(0) - com_m - way_m).norm(), 1e-11) << "step " << k;
        ASSERT_LT((arm.tip_position_m() - tip_m - way_m).norm(), 1e-11) << "step " << k;
      }
    }
  }
}

// The position is a length: it exceeds pi and multiples of it without a jump.
TYPED_TEST(Slider, GoesOnPastPi) {
  for (const double start_m : {3.0, -3.0, 40.0}) {
    const RobotModel model = make_slider({0, 1, 0});  // level
    auto arm = make_arm<TypeParam>(model, make_vector({start_m}));
    double before_m = read_positions(arm, 1)[0];
    EXPECT_EQ(before_m, start_m);
    for (int k = 0; k < 300; ++k) {
      step(arm, make_vector({std::copysign(80, start_m)}), 0.01);
      const double position_m = read_positions(arm, 1)[0];
      ASSERT_NEAR(position_m - before_m, 0.01 * read_rates(arm, 1)[0], 1e-11) << k;
      before_m = position_m;
    }
    EXPECT_GT(std::abs(before_m), std::abs(start_m) + 50);
  }
}

// Two planar mechanisms with centres of mass anywhere: a slider on a hinge (a polar manipulator)
// and a hinge on a slider (a cart with a pole). Both are derived from Lagrange's equations. c:
// centres of mass, d: the joint between the links, a: the slider's axis.
struct PlanarBodies {
  PlanarBodies(const RobotModel& model, const Plane& plane, std::size_t slider) {
    const auto project = [&](const Vector3d& p) {
      return Vector2d(p.dot(plane.u), p.dot(plane.v));
    };
    const Vector3d normal = plane.u.cross(plane.v);
    const Inertial &one = model.links[0].inertial, &two = model.links[1].inertial;
    m1 = one.mass_kg;
    m2 = two.mass_kg;
    i1 = normal.dot(one.inertia_kg_m2 * normal);
    i2 = normal.dot(two.inertia_kg_m2 * normal);
    c1 = project(one.com_m);
    c2 = project(two.com_m);
    d = project(model.joints[1].origin.translation());
    a = project(model.joints[slider].axis);
    gravity = project(Vector3d(0, 0, -kGravity_m_per_s2));
  }
  double m1, m2, i1, i2;
  Vector2d c1, c2, d, a, gravity;
};

struct PlanarEquations {
  Matrix2d mass;
  Vector2d bias;
  VectorXd calc_acceleration(const VectorXd& tau) const {
    return mass.inverse() * (Vector2d(tau) - bias);
  }
};

// The hinge turns by q1, the slider's centre of mass is at r = d + q2 a + c2 in the turning plane:
//   T = (i1 + m1 c1^2 + i2 + m2 r^2) q1'^2 / 2 + m2 (a . left(r)) q1' q2' + m2 q2'^2 / 2.
PlanarEquations calc_polar(const PlanarBodies& b, const VectorXd& q, const VectorXd& qd) {
  const Vector2d r = b.d + q[1] * b.a + b.c2;
  PlanarEquations e;
  const double coupling = b.m2 * b.a.dot(turn_left(r));
  e.mass << b.i1 + b.m1 * b.c1.squaredNorm() + b.i2 + b.m2 * r.squaredNorm(), coupling, coupling,
      b.m2;
  const double along = b.m2 * b.a.dot(r);
  e.bias << 2 * along * qd[0] * qd[1] -
                b.gravity.dot(turn(q[0], turn_left(b.m1 * b.c1 + b.m2 * r))),
      -along * qd[0] * qd[0] - b.m2 * b.gravity.dot(turn(q[0], b.a));
  return e;
}

// The slider moves by q1, the hinge turns by q2:
//   T = (m1 + m2) q1'^2 / 2 + m2 (a . left(R c2)) q1' q2' + (i2 + m2 c2^2) q2'^2 / 2.
PlanarEquations calc_cart_pole(const PlanarBodies& b, const VectorXd& q, const VectorXd& qd) {
  const Vector2d r = turn(q[1], b.c2);
  PlanarEquations e;
  const double coupling = b.m2 * b.a.dot(turn_left(r));
  e.mass << b.m1 + b.m2, coupling, coupling, b.i2 + b.m2 * b.c2.squaredNorm();
  e.bias << -b.m2 * b.a.dot(r) * qd[1] * qd[1] - (b.m1 + b.m2) * b.gravity.dot(b.a),
      -b.m2 * b.gravity.dot(turn_left(r));
  return e;
}

using PlanarFormula = PlanarEquations (*)(const PlanarBodies&, const VectorXd&, const VectorXd&);
struct PlanarCase {
  const char* name;
  std::size_t slider;
  PlanarFormula formula;
  VectorXd start, amplitude;
};
const std::vector<PlanarCase> kPlanarCases{
    {"polar", 1, calc_polar, make_vector({0.7, 0.4}), make_vector({17, 9})},
    {"cart and pole", 0, calc_cart_pole, make_vector({0.4, -1.1}), make_vector({31, -2.5})}};

RobotModel make_planar_model(const PlanarCase& kind, const Plane& plane) {
  RobotModel model = make_planar_arm(plane.u.cross(plane.v));
  Joint& slider = model.joints[kind.slider];
  slider.kind = JointKind::prismatic;
  slider.axis = (0.8 * plane.u - 0.6 * plane.v).normalized();
  return model;
}

// Checks the oracle itself; only rounding errors are allowed.
TEST(SlidingPlane, TheJacobianEquationsAgreeWithLagranges) {
  for (const PlanarCase& kind : kPlanarCases) {
    for (const Plane& plane : kPlanes) {
      const RobotModel model = make_planar_model(kind, plane);
      const PlanarBodies bodies(model, plane, kind.slider);
      const ChainOracle oracle(model, kGravity_m_per_s2);
      for (int i = 1; i < 20; ++i) {
        const VectorXd q = make_vector({0.3 * i, -0.7 * i}), qd = make_vector({3.1 - i, 0.4 * i});
        const PlanarEquations expected = kind.formula(bodies, q, qd);
        const ChainOracle::Equations found = oracle.calc(q, qd);
        EXPECT_LT((found.mass - expected.mass).norm(), 1e-12 * expected.mass.norm())
            << kind.name << ", " << plane.name;
        EXPECT_LT((found.bias - expected.bias).norm(), 1e-12 * expected.bias.norm())
            << kind.name << ", " << plane.name;
      }
    }
  }
}

TYPED_TEST(Slider, BesideAHingeFollowsLagrangesEquations) {
  for (const PlanarCase& kind : kPlanarCases) {
    for (const Plane& plane : kPlanes) {
      SCOPED_TRACE(testing::Message() << kind.name << ", " << plane.name);
      const RobotModel model = make_planar_model(kind, plane);
      const PlanarBodies bodies(model, plane, kind.slider);
      expect_solves<TypeParam>(
          model,
          [&](double t_s, const VectorXd& q, const VectorXd& qd) {
            return kind.formula(bodies, q, qd).calc_acceleration(calc_drive(kind.amplitude, t_s));
          },
          kind.start, kind.amplitude);
    }
  }
}

struct MixedCase {
  const char* kinds;
  VectorXd amplitude;
};
const std::vector<MixedCase> kMixedCases{{"rpr", make_vector({9, 12, 0.7})},
                                         {"prp", make_vector({30, 8, 9})},
                                         {"rrp", make_vector({9, 6, 9})},
                                         {"ppr", make_vector({30, 20, 0.7})},
                                         {"ppp", make_vector({40, 25, 14})}};
const VectorXd kMixedStart = make_vector({0.6, -0.9, 0.3});

// Without efforts, RK4 conserves the oracle's energy up to its own error. The oracle's equations,
// including the sliders' Coriolis terms, are therefore consistent with its energy.
TEST(MixedChain, TheJacobianEquationsKeepTheirEnergy) {
  for (const MixedCase& mixed : kMixedCases) {
    const RobotModel model = make_mixed_arm(mixed.kinds);
    const ChainOracle oracle(model, kGravity_m_per_s2);
    const State start{kMixedStart, make_vector({1.1, -0.7, 1.3})};
    const State end = integrate_rk4(
        [&](double, const VectorXd& q, const VectorXd& qd) {
          return oracle.calc_acceleration(q, qd, VectorXd::Zero(3));
        },
        start, kTruthSteps, 1.0 / kTruthSteps);
    const auto energy = [&](const State& s) {
      return oracle.calc_kinetic_energy_j(s.q, s.qd) + oracle.calc(s.q, s.qd).potential_energy_j;
    };
    ASSERT_GT((end.q - start.q).norm(), 1) << mixed.kinds;
    EXPECT_NEAR(energy(end), energy(start), 1e-8) << mixed.kinds;
  }
}

template <class Arm>
class MixedArm : public testing::Test {};
TYPED_TEST_SUITE(MixedArm, ArmTypes, ArmNames);

TYPED_TEST(MixedArm, FollowsTheEquationsOfMotion) {
  for (const MixedCase& mixed : kMixedCases) {
    SCOPED_TRACE(mixed.kinds);
    const RobotModel model = make_mixed_arm(mixed.kinds);
    const ChainOracle oracle(model, kGravity_m_per_s2);
    expect_solves<TypeParam>(model, make_driven_acceleration(oracle, mixed.amplitude), kMixedStart,
                             mixed.amplitude);
  }
}

TYPED_TEST(MixedArm, TheFirstStepHasTheAccelerationsOfTheEquationsOfMotion) {
  for (const MixedCase& mixed : kMixedCases) {
    for (const VectorXd& tau : {make_vector({0, 0, 0}), make_vector({21, -13, 4.5})}) {
      SCOPED_TRACE(mixed.kinds);
      expect_first_step<TypeParam>(make_mixed_arm(mixed.kinds), kMixedStart, tau, 0.002);
    }
  }
}

// Chains of one to eight joints, revolute or prismatic, of any shape and in any posture.
TYPED_TEST(MixedArm, RandomChainsTakeTheFirstStepOfTheEquationsOfMotion) {
  std::size_t sliders = 0, hinges = 0;
  for (std::size_t joints = 1; joints <= 8; ++joints) {
    for (std::uint64_t number = 0; number < 10; ++number) {
      SCOPED_TRACE(testing::Message() << joints << " joints, number " << number);
      RandomStream random("test/physics/chains", 100 * joints + number);
      const RobotModel model = make_random_arm(joints, random);
      VectorXd start(static_cast<Eigen::Index>(joints)), tau = start;
      for (Eigen::Index i = 0; i < start.size(); ++i) {
        start[i] = random.uniform(-1.5, 1.5);
        tau[i] = random.uniform(-20, 20);
        ++(is_prismatic(model, i) ? sliders : hinges);
      }
      expect_first_step<TypeParam>(model, start, tau, 0.001);
    }
  }
  EXPECT_GT(sliders, 100u);
  EXPECT_GT(hinges, 100u);
}

}  // namespace
}  // namespace armwright::physics_test
