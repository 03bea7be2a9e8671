// Chains of two and three links against equations of motion written here.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "chain_oracle.hpp"
#include "convergence.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Vector2d turn(double angle_rad, const Vector2d& v) {
  return Eigen::Rotation2Dd(angle_rad) * v;
}
Vector2d turn_left(const Vector2d& v) {
  return {-v.y(), v.x()};
}

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

VectorXd make_vector(std::initializer_list<double> values) {
  VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

// Smooth driving efforts, different in every joint.
VectorXd calc_drive(const VectorXd& amplitude_n_m, double t_s) {
  VectorXd tau(amplitude_n_m.size());
  for (Eigen::Index i = 0; i < tau.size(); ++i) {
    const double k = static_cast<double>(i);
    tau[i] = amplitude_n_m[i] * std::sin((3 + k) * t_s + 0.5 + k);
  }
  return tau;
}

// Angles (turns counted) and rates after a second of driving.
VectorXd simulate(const RobotModel& model, const VectorXd& start, const VectorXd& amplitude_n_m,
                  int steps) {
  const double h_s = 1.0 / steps;
  const auto joints = static_cast<std::size_t>(start.size());
  OdeArm arm = make_arm(model, start);
  VectorXd q = start;
  for (int k = 0; k < steps; ++k) {
    step(arm, calc_drive(amplitude_n_m, k * h_s), h_s);
    q += wrap_angles(read_angles(arm, joints) - q);
  }
  VectorXd state(2 * start.size());
  state << q, read_rates(arm, joints);
  return state;
}

VectorXd flatten(const State& s) {
  VectorXd state(2 * s.q.size());
  state << s.q, s.qd;
  return state;
}

constexpr int kTruthSteps = 4000;  // RK4's error is then below 1e-9, four orders below the others

// The engine's limit h -> 0 is the solution of the equations; on the way there its error is of
// first order, like that of semi-implicit Euler in joint coordinates, but with a constant of its
// own (links move along tangents). Measured: up to 3 times as large; 4 is allowed.
void expect_solves(const RobotModel& model, const Acceleration& f, const VectorXd& start,
                   const VectorXd& amplitude_n_m) {
  const State rest{start, VectorXd::Zero(start.size())};
  const VectorXd truth = flatten(integrate_rk4(f, rest, kTruthSteps, 1.0 / kTruthSteps));
  ASSERT_LT((flatten(integrate_rk4(f, rest, kTruthSteps / 2, 2.0 / kTruthSteps)) - truth).norm(),
            1e-8);
  ASSERT_GT((truth.head(start.size()) - start).cwiseAbs().minCoeff(), 0.2) << "hardly moves";

  const Limit engine =
      extrapolate([&](int steps) { return simulate(model, start, amplitude_n_m, steps); }, 800);
  EXPECT_NEAR(engine.order, 1, kOrderTolerance);
  EXPECT_LT(engine.error, 1e-3 * truth.norm());  // or the next line would say little
  EXPECT_LT((engine.value - truth).norm(), engine.error);

  for (const int steps : {200, 1000, 3200}) {
    const VectorXd euler = flatten(integrate_semi_implicit_euler(f, rest, steps, 1.0 / steps));
    const VectorXd ode = simulate(model, start, amplitude_n_m, steps);
    EXPECT_LT((ode - truth).norm(), 4 * (euler - truth).norm()) << steps << " steps";
    EXPECT_LT((ode - euler).norm(), 4 * (euler - truth).norm()) << steps << " steps";
  }
}

struct Plane {
  const char* name;
  Vector3d u, v;  // u x v: the joints' axis
};
void PrintTo(const Plane& plane, std::ostream* out) {
  *out << plane.name;
}
const Plane kVertical{"vertical", {0, 0, 1}, {1, 0, 0}};
const Plane kHorizontal{"horizontal", {1, 0, 0}, {0, 1, 0}};
const Plane kInclined{"inclined", Vector3d(1, 2, 2) / 3, Vector3d(2, 1, -2) / 3};

const VectorXd kTwoAngles = make_vector({0.7, -1.1});
const VectorXd kTwoEfforts_n_m = make_vector({9, -2.5});
const VectorXd kThreeAngles = make_vector({0.6, -0.9, 1.3});
const VectorXd kThreeEfforts_n_m = make_vector({4, -3, 0.7});

class TwoLinkArm : public testing::TestWithParam<Plane> {};
INSTANTIATE_TEST_SUITE_P(Planes, TwoLinkArm, testing::Values(kVertical, kHorizontal, kInclined),
                         [](const auto& plane) { return std::string(plane.param.name); });

TEST_P(TwoLinkArm, FollowsTheTextbookEquations) {
  const Plane& plane = GetParam();
  const RobotModel model = make_planar_arm(plane.u.cross(plane.v));
  const PlanarManipulator textbook(model, plane.u, plane.v, kGravity_m_per_s2);
  expect_solves(
      model,
      [&](double t_s, const VectorXd& q, const VectorXd& qd) {
        return textbook.calc_acceleration(q, qd, calc_drive(kTwoEfforts_n_m, t_s));
      },
      kTwoAngles, kTwoEfforts_n_m);
}

// The oracle of the spatial arms, checked itself: rounding only.
TEST_P(TwoLinkArm, TheJacobianEquationsAgreeWithTheTextbooks) {
  const Plane& plane = GetParam();
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

// Without efforts RK4 keeps the oracle's energy to its own error: the equations of the skew arm,
// gyroscopic terms included, are consistent with its energy.
TEST(SkewArm, TheJacobianEquationsKeepTheirEnergy) {
  const RobotModel model = make_skew_arm();
  const ChainOracle oracle(model, kGravity_m_per_s2);
  const State start{kThreeAngles, make_vector({1.1, -0.7, 2.3})};
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

TEST(SkewArm, FollowsTheEquationsOfMotion) {
  const RobotModel model = make_skew_arm();
  const ChainOracle oracle(model, kGravity_m_per_s2);
  expect_solves(
      model,
      [&](double t_s, const VectorXd& q, const VectorXd& qd) {
        return oracle.calc_acceleration(q, qd, calc_drive(kThreeEfforts_n_m, t_s));
      },
      kThreeAngles, kThreeEfforts_n_m);
}

// The first step from rest is exact: every centre of mass moves by h^2 times its acceleration, but
// for rounding (of positions of size 2, over h^2: 1e-10), and qd = h qdd. Rates are measured along
// the axes after the step, though, which have turned by up to h |qd|: half its square, relative.
TEST(SkewArm, TheFirstStepHasTheAccelerationsOfTheEquationsOfMotion) {
  const RobotModel model = make_skew_arm();
  const ChainOracle oracle(model, kGravity_m_per_s2);
  const double h_s = 0.002;
  for (const VectorXd& tau : {make_vector({0, 0, 0}), make_vector({21, -13, 4.5})}) {
    OdeArm arm = make_arm(model, kThreeAngles);
    const ChainOracle::Equations equations = oracle.calc(kThreeAngles, VectorXd::Zero(3));
    const VectorXd acceleration = equations.mass.ldlt().solve(tau - equations.bias);
    step(arm, tau, h_s);
    const double turn = h_s * h_s * acceleration.cwiseAbs().sum();
    EXPECT_LT((read_rates(arm, 3) / h_s - acceleration).norm(),
              turn * turn / 2 * acceleration.norm());
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d moved = (arm.com_position_m(i) - equations.com_m[i]) / (h_s * h_s);
      EXPECT_LT((moved - equations.com_jacobian[i] * acceleration).norm(), 1e-9) << "link " << i;
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
