// Compares the equations of motion in joint coordinates with those from the bodies' Jacobians.
// Chains are general, or have axes that are parallel, opposite or at right angles, exactly or
// nearly. For the exact cases the engine leaves out arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "chain_oracle.hpp"
#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "test_arms.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

// Rounding of some thousand operations at 1e-16 each, in different orders. For axes that differ by
// a microradian, the engine rounds the cosine 1 - 5e-13 to 1, which gives that error at every
// joint.
constexpr double kRounding = 1e-12, kRoundingOfTilted = 1e-10;

struct Drawn {
  std::string name;
  RobotModel model;
  double rounding;
};

Vector3d draw_direction(RandomStream& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return Vector3d(x, y, random.uniform(-1, 1)).normalized();
}

// Draws one of x, y, z and their opposites.
Vector3d draw_main_direction(RandomStream& random) {
  Vector3d v = Vector3d::Zero();
  v[static_cast<Eigen::Index>(random.uniform(0, 3))] = random.uniform(0, 1) < 0.5 ? -1 : 1;
  return v;
}

// Gives joint i an axis and turns its frame against the one before.
void place(RobotModel& model, std::size_t i, const Vector3d& axis, const Matrix3d& turn) {
  model.joints[i].axis = axis;
  model.joints[i].origin.linear() = turn;
}

// Frames turned by quarter turns, with axes and offsets along them: axes are parallel, opposite or
// at right angles.
void align_axes(RobotModel& model, RandomStream& random) {
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const int quarters = static_cast<int>(random.uniform(0, 4));
    Matrix3d turn = make_rotation(draw_main_direction(random), quarters * kPi / 2);
    place(model, i, draw_main_direction(random), turn);
    model.joints[i].origin.translation() = draw_main_direction(random) * random.uniform(0, 1);
  }
}

// Groups of one to four joints about the same axis, which has a general direction.
void group_axes(RobotModel& model, RandomStream& random) {
  Vector3d axis = draw_direction(random);
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    if (random.uniform(0, 1) < 0.4) {
      axis = draw_direction(random);
    }
    place(model, i, axis, make_rotation(axis, random.uniform(-2, 2)));
  }
}

// Axes that differ by a microradian from the axis before or from its opposite.
void tilt_axes(RobotModel& model, RandomStream& random) {
  Vector3d axis = draw_direction(random);
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const Vector3d across = axis.cross(draw_direction(random)).normalized();
    axis = (random.uniform(0, 1) < 0.3 ? -1 : 1) * (axis + 1e-6 * across).normalized();
    place(model, i, axis, make_rotation(axis, random.uniform(-2, 2)));
  }
}

// Chains of one to eight and of twelve joints: all revolute, or with prismatic ones.
std::vector<Drawn> make_chains(bool sliders) {
  std::vector<Drawn> chains;
  for (const std::size_t joints : {1, 2, 3, 4, 5, 6, 7, 8, 12}) {
    for (std::uint64_t number = 0; number < 6; ++number) {
      const std::string which =
          std::to_string(joints) + " joints, number " + std::to_string(number);
      using Shaper = void (*)(RobotModel&, RandomStream&);
      const std::pair<const char*, Shaper> shapers[] = {
          {"general, ", [](RobotModel&, RandomStream&) {}},
          {"aligned, ", align_axes},
          {"grouped, ", group_axes},
          {"tilted, ", tilt_axes}};
      for (const auto& [name, shape] : shapers) {
        RandomStream random("test/physics/articulated", 100 * joints + number);
        RobotModel model = make_random_arm(joints, random);
        shape(model, random);
        for (Joint& joint : model.joints) {
          joint.kind = sliders ? joint.kind : JointKind::revolute;
        }
        if (!sliders || has_slider(model)) {
          chains.push_back(
              {name + which, std::move(model), shape == tilt_axes ? kRoundingOfTilted : kRounding});
        }
      }
    }
  }
  return chains;
}

struct Motion {
  VectorXd q, qd;
};
Motion draw_motion(const RobotModel& model, std::uint64_t number) {
  RandomStream random("test/physics/articulated/motion", number);
  const auto n = static_cast<Eigen::Index>(model.joint_count());
  Motion m{VectorXd(n), VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    m.q[i] = is_prismatic(model, i) ? random.uniform(-1, 1) : random.uniform(-7, 7);
    m.qd[i] = random.uniform(-3, 3);
  }
  return m;
}

PhysicsSettings make_physics(double gravity) {
  PhysicsSettings physics;
  physics.gravity_m_per_s2 = gravity;
  return physics;
}

void set_motion(ArticulatedArm& arm, const Motion& m) {
  const auto n = static_cast<std::size_t>(m.q.size());
  arm.set_state({m.q.data(), n}, {m.qd.data(), n});
}

void expect_equations(const RobotModel& model, double gravity, const Motion& m,
                      const MatrixXd& mass, const VectorXd& bias, double rounding) {
  const ChainOracle::Equations expected = ChainOracle(model, gravity).calc(m.q, m.qd);
  EXPECT_LT((mass - expected.mass).norm(), rounding * expected.mass.norm());
  // Parts of the bias may cancel. Without gravity and at rest it is zero.
  const double size = expected.mass.norm() * (m.qd.squaredNorm() + gravity);
  EXPECT_LT((bias - expected.bias).norm(), rounding * (expected.bias.norm() + size));
}

TEST(ArticulatedArm, HasTheEquationsOfMotionOfTheJacobians) {
  std::uint64_t number = 0;
  for (const bool sliders : {false, true}) {
    for (const Drawn& chain : make_chains(sliders)) {
      SCOPED_TRACE(chain.name + (sliders ? ", sliders" : ""));
      for (const double gravity : {0.0, kGravity_m_per_s2}) {
        const Motion m = draw_motion(chain.model, number++);
        ArticulatedArm arm = make_arm<ArticulatedArm>(chain.model, m.q, make_physics(gravity));
        set_motion(arm, m);
        expect_equations(chain.model, gravity, m, arm.calc_mass_matrix(), arm.calc_bias(),
                         chain.rounding);
        const auto oracle = ChainOracle(chain.model, gravity).calc(m.q, m.qd);
        EXPECT_LT((arm.tip_position_m() - oracle.tip_m).norm(), chain.rounding);
      }
    }
  }
}

// Tests the variants of the code that leave out what revolute joints, or the palletiser, do not
// need.
struct TestLevel;
using Lane = lanes::Single<double, TestLevel>;
struct Equations {
  MatrixXd mass;
  VectorXd bias, acceleration;
};
template <class Chain>
Equations calc_equations(const RobotModel& robot, double gravity, const Motion& m,
                         const VectorXd& tau) {
  const articulated::ChainModel model(robot, gravity);
  const int n = model.joints();
  const std::vector<Lane> numbers(model.numbers().begin(), model.numbers().end());
  const std::vector<Lane> q(m.q.begin(), m.q.end()), qd(m.qd.begin(), m.qd.end());
  const std::vector<Lane> effort(tau.begin(), tau.end());
  std::vector<Lane> scratch(static_cast<std::size_t>(articulated::calc_dynamics_packs(n)));
  std::vector<Lane> acceleration(q.size());
  Lane* memory = scratch.data();
  const Chain chain(n, model.flags().data(), model.tilted_gravity());
  articulated::ChainDynamics<Lane, Chain> dynamics(chain, numbers.data(), memory);
  dynamics.set_posture(q.data(), false);
  dynamics.calc_equations(q.data(), qd.data());
  Equations e{MatrixXd(n, n), VectorXd(n), VectorXd(n)};
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column <= row; ++column) {
      e.mass(row, column) = e.mass(column, row) = dynamics.mass(row, column).v;
    }
    e.bias[row] = dynamics.bias(row).v;
  }
  dynamics.solve(effort.data(), acceleration.data());
  for (int row = 0; row < n; ++row) {
    e.acceleration[row] = acceleration[static_cast<std::size_t>(row)].v;
  }
  return e;
}

TEST(ArticulatedChain, OfTurningJointsHasTheEquationsOfMotionOfTheJacobians) {
  using Chain = articulated::ChainShape<0, articulated::kAnyShape, false>;
  std::uint64_t number = 0;
  for (const Drawn& drawn : make_chains(false)) {
    SCOPED_TRACE(drawn.name);
    for (const double gravity : {0.0, kGravity_m_per_s2}) {
      const Motion m = draw_motion(drawn.model, number++);
      const Equations e = calc_equations<Chain>(drawn.model, gravity, m, m.q);
      expect_equations(drawn.model, gravity, m, e.mass, e.bias, drawn.rounding);
    }
  }
}

// Tests the thesis's arm, and the same arm with other masses, lengths and inertias.
RobotModel make_palletiser(std::uint64_t number) {
  RandomStream random("test/physics/palletiser", number);
  RobotModel model = load_irb4600();
  const RobotModel other = make_random_arm(4, random);
  for (std::size_t i = 0; number > 0 && i < 4; ++i) {
    model.links[i].inertial = other.links[i].inertial;
    model.joints[i].origin.translation() *= random.uniform(0.5, 2);
  }
  return model;
}

TEST(ArticulatedChain, OfAPalletiserHasTheEquationsOfMotionOfTheJacobians) {
  using Chain = articulated::ChainShape<4, articulated::kPalletiser, false>;
  for (std::uint64_t number = 0; number < 50; ++number) {
    SCOPED_TRACE(number);
    const RobotModel model = make_palletiser(number);
    const articulated::ChainModel chain(model, kGravity_m_per_s2);
    ASSERT_TRUE(articulated::has_shape(chain.flags().data(), 4, articulated::kPalletiser));
    const Motion m = draw_motion(model, number);
    const Equations e = calc_equations<Chain>(model, kGravity_m_per_s2, m, m.q);
    expect_equations(model, kGravity_m_per_s2, m, e.mass, e.bias, kRounding);
  }
}

// Computes tau from an acceleration, and the acceleration from tau. Solving a system with M loses
// as many digits as the condition number of M has.
TEST(ArticulatedArm, ForwardDynamicsInvertsInverseDynamics) {
  std::uint64_t number = 0;
  for (const bool sliders : {false, true}) {
    for (const Drawn& chain : make_chains(sliders)) {
      SCOPED_TRACE(chain.name + (sliders ? ", sliders" : ""));
      const Motion m = draw_motion(chain.model, ++number);
      const VectorXd acceleration = draw_motion(chain.model, ~number).qd;
      const auto inverse = ChainOracle(chain.model, kGravity_m_per_s2).calc(m.q, m.qd);
      const VectorXd tau = inverse.mass * acceleration + inverse.bias;
      ArticulatedArm arm = make_arm<ArticulatedArm>(chain.model, m.q);
      set_motion(arm, m);
      step(arm, tau, 1);
      const VectorXd found = read_rates(arm, chain.model.joint_count()) - m.qd;
      const VectorXd eigenvalues = inverse.mass.selfadjointView<Eigen::Lower>().eigenvalues();
      const double condition = eigenvalues.maxCoeff() / eigenvalues.minCoeff();
      const double size =
          acceleration.norm() + m.qd.norm() + inverse.bias.norm() / eigenvalues.maxCoeff();
      EXPECT_LT((found - acceleration).norm(), 0.1 * chain.rounding * condition * size);
      ASSERT_LT(condition, 1e7);  // otherwise the tolerance above would be too wide
    }
  }
}

TEST(ArticulatedArm, TheMassMatrixIsPositiveDefiniteAndHoldsTheKineticEnergy) {
  std::uint64_t number = 0;
  for (const bool sliders : {false, true}) {
    for (const Drawn& chain : make_chains(sliders)) {
      SCOPED_TRACE(chain.name + (sliders ? ", sliders" : ""));
      const Motion m = draw_motion(chain.model, ++number);
      ArticulatedArm arm = make_arm<ArticulatedArm>(chain.model, m.q);
      set_motion(arm, m);
      const MatrixXd mass = arm.calc_mass_matrix();
      EXPECT_GT(mass.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
      const double energy_j = 0.5 * m.qd.dot(mass * m.qd);
      EXPECT_GT(energy_j, 0);
      EXPECT_NEAR(arm.calc_kinetic_energy_j(), energy_j,
                  chain.rounding * mass.norm() * m.qd.squaredNorm());
    }
  }
}

// At rest the bias is the gradient of the potential energy, also if the first axis is horizontal or
// inclined. Central differences over 1e-4 have an error of 1e-8 / 6 times third derivatives, which
// have the energy's size, and of rounding divided by 1e-4.
TEST(ArticulatedArm, GravityIsTheGradientOfThePotentialEnergy) {
  std::uint64_t number = 0;
  for (const bool sliders : {false, true}) {
    for (Drawn& chain : make_chains(sliders)) {
      SCOPED_TRACE(chain.name + (sliders ? ", sliders" : ""));
      const Vector3d first_axes[] = {
          chain.model.joints[0].axis, {0.6, -0.8, 0}, {0, 0, 1}, {0, 0, -1}};
      for (const Vector3d& axis : first_axes) {
        chain.model.joints[0].axis = axis;
        chain.model.joints[0].origin.linear().setIdentity();
        Motion m = draw_motion(chain.model, ++number);
        m.qd.setZero();
        ArticulatedArm arm = make_arm<ArticulatedArm>(chain.model, m.q);
        const VectorXd bias = arm.calc_bias();
        VectorXd gradient(m.q.size());
        double weight_n = 0;
        for (const Link& link : chain.model.links) {
          weight_n += kGravity_m_per_s2 * link.inertial.mass_kg;
        }
        for (Eigen::Index i = 0; i < m.q.size(); ++i) {
          double energies_j[2];
          for (const int side : {0, 1}) {
            Motion moved = m;
            moved.q[i] += side == 0 ? -1e-4 : 1e-4;
            set_motion(arm, moved);
            energies_j[side] = arm.calc_potential_energy_j();
          }
          gradient[i] = (energies_j[1] - energies_j[0]) / 2e-4;
        }
        // Levers of at most 2 m per joint.
        EXPECT_LT((bias - gradient).norm(), 1e-8 * weight_n * 2 * static_cast<double>(m.q.size()));
        set_motion(arm, m);
      }
    }
  }
}

// Centrifugal and Coriolis efforts do the work that changes the kinetic energy: M' being the rate
// of change of M, qd (b(q, qd) - b(q, 0)) = qd M' qd / 2. Central differences as above.
TEST(ArticulatedArm, VelocityTermsKeepTheEnergy) {
  std::uint64_t number = 0;
  for (const bool sliders : {false, true}) {
    for (const Drawn& chain : make_chains(sliders)) {
      SCOPED_TRACE(chain.name + (sliders ? ", sliders" : ""));
      const Motion m = draw_motion(chain.model, ++number);
      ArticulatedArm arm = make_arm<ArticulatedArm>(chain.model, m.q);
      const VectorXd at_rest = arm.calc_bias();
      set_motion(arm, m);
      const double power_w = m.qd.dot(arm.calc_bias() - at_rest);
      const double mass_norm = arm.calc_mass_matrix().norm();
      constexpr double kStep_s = 1e-5;
      set_motion(arm, {m.q + kStep_s * m.qd, m.qd});
      const double after_j = arm.calc_kinetic_energy_j();
      set_motion(arm, {m.q - kStep_s * m.qd, m.qd});
      const double before_j = arm.calc_kinetic_energy_j();
      EXPECT_NEAR(power_w, (after_j - before_j) / (2 * kStep_s),
                  1e-7 * mass_norm * std::pow(m.qd.norm(), 3));
    }
  }
}

TEST(ArticulatedArm, WithoutGravityNothingMovesAtRest) {
  for (const Drawn& chain : make_chains(true)) {
    const Motion m = draw_motion(chain.model, 7);
    auto arm = make_arm<ArticulatedArm>(chain.model, m.q, make_physics(0));
    EXPECT_EQ(arm.calc_bias(), VectorXd::Zero(m.q.size())) << chain.name;
  }
}

}  // namespace
}  // namespace armwright::physics_test
