// Tests an arm's start posture, the direction of its motion, the efforts that hold it at rest, and
// that its joints hold together.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "test_arms.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

// The IRB 4600, computed by hand. In the vertical plane of the arm, x points outwards and z up, and
// a joint angle turns x to -z (axis +y). r: from the joint to the link's centre of mass, s: to the
// next joint.
struct HandLink {
  double mass_kg;
  double r_x, r_z, s_x, s_z;
};
constexpr std::array<HandLink, 3> kHandLinks{{{266.3, 0.00006, 0.48764, 0, 1.095},
                                              {545.6, 0.22749, 0.13050, 1.270, 0.175},
                                              {13.8, 0.01617, 0.00037, 0, 0}}};

// Returns the sum of m g x lever arm over everything that a joint carries. It turns the arm forward
// and down about the axis +y, so the effort that holds it is the negative.
VectorXd calc_holding_efforts_by_hand(const VectorXd& q) {
  std::array<double, 3> joint_x{}, com_x{};
  double x = 0, turn = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    turn += q[static_cast<Eigen::Index>(i) + 1];
    const HandLink& link = kHandLinks[i];
    joint_x[i] = x;
    com_x[i] = x + link.r_x * std::cos(turn) + link.r_z * std::sin(turn);
    x += link.s_x * std::cos(turn) + link.s_z * std::sin(turn);
  }
  VectorXd tau = VectorXd::Zero(4);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = i; k < 3; ++k) {
      tau[static_cast<Eigen::Index>(i) + 1] -=
          kHandLinks[k].mass_kg * kGravity_m_per_s2 * (com_x[k] - joint_x[i]);
    }
  }
  return tau;
}

template <class Arm>
class Irb4600 : public testing::Test {};
TYPED_TEST_SUITE(Irb4600, ArmTypes, ArmNames);

// Postures may be unstable equilibria: rounding (1e-16 of efforts of 1e4 N m, on the 0.05 kg m2 of
// the last link) grows by up to e^6, 6 /s being the last link's sqrt(m g l / J). A micrometre of
// misplaced mass in link 2 would move it by 1e-5 rad.
TYPED_TEST(Irb4600, StandsStillUnderTheEffortsComputedByHand) {
  const RobotModel model = load_irb4600();
  for (const VectorXd& q : {make_vector({0.4, 0.3, -0.5, 0.7}), make_vector({-2.1, 1.2, 0.6, -0.8}),
                            make_vector({3.0, -0.7, 0.9, 0.35})}) {
    auto arm = make_arm<TypeParam>(model, q);
    const VectorXd tau = calc_holding_efforts_by_hand(q);
    ASSERT_GT(tau.tail(2).cwiseAbs().minCoeff(), 0.5) << "no load, no test";
    double fastest = 0;
    for (int k = 0; k < 100; ++k) {
      step(arm, tau, 0.01);
      fastest = std::max(fastest, read_rates(arm, 4).norm());
    }
    EXPECT_LT(calc_motion(model, q, read_positions(arm, 4)).norm(), 1e-9);
    EXPECT_LT(fastest, 1e-8);
  }
}

// With one per cent more effort in one joint, the arm does not stay at rest.
TYPED_TEST(Irb4600, MovesUnderAnyOtherEffort) {
  const RobotModel model = load_irb4600();
  const VectorXd q = make_vector({0.4, 0.3, -0.5, 0.7});
  for (Eigen::Index i = 1; i < 4; ++i) {
    VectorXd tau = calc_holding_efforts_by_hand(q);
    tau[i] *= 1.01;
    auto arm = make_arm<TypeParam>(model, q);
    double farthest = 0;
    for (int k = 0; k < 100; ++k) {
      step(arm, tau, 0.01);
      farthest = std::max(farthest, calc_motion(model, q, read_positions(arm, 4)).norm());
    }
    EXPECT_GT(farthest, 1e-3) << "joint " << i + 1;
  }
}

struct PosedArm {
  const char* name;
  RobotModel model;
};
const std::vector<PosedArm> kPosedArms{{"planar", make_planar_arm({0, 1, 0})},
                                       {"skew", make_skew_arm()},
                                       {"irb4600", load_irb4600()},
                                       {"rpr", make_mixed_arm("rpr")},
                                       {"prp", make_mixed_arm("prp")}};

template <class Arm>
class AnyArm : public testing::Test {};
TYPED_TEST_SUITE(AnyArm, ArmTypes, ArmNames);

VectorXd select_first(const VectorXd& values, const RobotModel& model) {
  return values.head(static_cast<Eigen::Index>(model.joint_count()));
}

// M is positive definite, and so is its inverse. Therefore an effort in a joint accelerates that
// joint in the effort's direction.
TYPED_TEST(AnyArm, APositiveEffortMovesItsJointPositively) {
  for (const auto& [name, model] : kPosedArms) {
    const std::size_t joints = model.joint_count();
    PhysicsSettings physics;
    physics.gravity_m_per_s2 = 0;
    const VectorXd q = select_first(make_vector({0.4, -0.8, 1.2, -0.3}), model);
    for (std::size_t i = 0; i < joints; ++i) {
      for (const double sign : {1.0, -1.0}) {
        SCOPED_TRACE(testing::Message() << name << ", joint " << i + 1);
        auto arm = make_arm<TypeParam>(model, q, physics);
        VectorXd tau = VectorXd::Zero(q.size());
        const auto joint = static_cast<Eigen::Index>(i);
        tau[joint] = sign * 3.3;
        step(arm, tau, 0.01);
        const VectorXd rates = read_rates(arm, joints);
        const double moved = (read_positions(arm, joints) - q)[joint];
        EXPECT_GT(sign * rates[joint], 0);
        // Semi-implicit: it moved by h times the new rate, up to the square of the turn per step.
        const double turn_rad = calc_turn_rad(model, rates, 0.01);
        EXPECT_NEAR(moved, 0.01 * rates[joint], turn_rad * turn_rad + 1e-14);
      }
    }
  }
}

// Positions of size pi, their trigonometric functions and a few products: 1e-14.
TYPED_TEST(AnyArm, StartsAtRestInThePostureAskedFor) {
  for (const auto& [name, model] : kPosedArms) {
    SCOPED_TRACE(name);
    const ChainOracle oracle(model, kGravity_m_per_s2);
    const VectorXd rest = select_first(VectorXd::Zero(4), model);
    for (const VectorXd& posture :
         {make_vector({0.4, -0.8, 1.2, -0.3}), make_vector({3.1, -3.1, 2.9, -2.8}),
          make_vector({kPi - 1e-9, -kPi + 1e-9, kPi - 1e-3, -3}),
          make_vector({kPi, -kPi, -kPi, kPi}), make_vector({4.5, -7.7, 11.2, -3.3})}) {
      const VectorXd q = select_first(posture, model);
      const auto arm = make_arm<TypeParam>(model, q);
      const VectorXd measured = read_positions(arm, model.joint_count());
      EXPECT_LT(calc_motion(model, q, measured).norm(), 1e-14) << q.transpose();
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        EXPECT_TRUE(is_prismatic(model, i) || std::abs(measured[i]) <= kPi) << measured[i];
      }
      EXPECT_EQ(read_rates(arm, model.joint_count()), rest);
      const ChainOracle::Equations at = oracle.calc(q, rest);
      EXPECT_LT((arm.tip_position_m() - at.tip_m).norm(), 1e-14) << q.transpose();
      for (std::size_t i = 0; i < model.joint_count(); ++i) {
        EXPECT_LT((arm.com_position_m(i) - at.com_m[i]).norm(), 1e-14) << "link " << i + 1;
      }
    }
  }
}

// A joint turns for many turns, from just before pi and in both directions. Angles stay in [-pi,
// pi] and equal the sum of the rates modulo a turn, up to the rotation update's error of h w^3 / 12
// per step.
TYPED_TEST(AnyArm, AnglesWrapAtPi) {
  const RobotModel model = make_pendulum({0.5, 0.8, 0.4});
  PhysicsSettings physics;
  physics.gravity_m_per_s2 = 0;
  for (const double sign : {1.0, -1.0}) {
    auto arm = make_arm<TypeParam>(model, VectorXd::Constant(1, sign * 3.1), physics);
    const double h_s = 0.001;
    double expected = sign * 3.1, largest = 0;
    int wraps = 0;
    for (int k = 0; k < 4000; ++k) {
      const double before = read_positions(arm, 1)[0];
      step(arm, VectorXd::Constant(1, sign * 2.5), h_s);
      const double angle = read_positions(arm, 1)[0], rate = read_rates(arm, 1)[0];
      ASSERT_LE(std::abs(angle), kPi);
      largest = std::max(largest, std::abs(angle));
      wraps += std::abs(angle - before) > kPi ? 1 : 0;
      expected += h_s * rate;
      // 4000 x (h w)^3 / 12 with w < 20 rad/s, and the hinge's pull on the drifting link
      ASSERT_LT(std::abs(std::remainder(angle - expected, 2 * kPi)), 4000 * 8e-6 / 12 + 0.02) << k;
    }
    EXPECT_GE(wraps, 3);
    EXPECT_GT(largest, 3.13);
  }
}

// The tip agrees with the forward kinematics of the joint positions, up to the gaps in the joints.
TYPED_TEST(AnyArm, ItsJointsHoldOverAThousandStepsOfFreeMotion) {
  for (const auto& [name, model] : kPosedArms) {
    const std::size_t joints = model.joint_count();
    const ChainOracle oracle(model, kGravity_m_per_s2);
    const VectorXd start = select_first(make_vector({0.4, -0.8, 1.2, -0.3}), model);
    double reach_m = model.tip_pose.translation().norm();
    for (std::size_t i = 1; i < joints; ++i) {
      reach_m += model.joints[i].origin.translation().norm();
    }
    for (const double h_s : {0.002, 0.001}) {
      SCOPED_TRACE(testing::Message() << name << ", step " << h_s);
      const PhysicsSettings physics;
      auto arm = make_arm<TypeParam>(model, start, physics);
      double worst_m = 0, fastest = 0, turn_rad = 0, farthest_m = 0;
      for (int k = 0; k < 1000; ++k) {
        step(arm, VectorXd::Zero(start.size()), h_s);
        const VectorXd q = read_positions(arm, joints), qd = read_rates(arm, joints);
        fastest = std::max(fastest, qd.cwiseAbs().sum());
        turn_rad = std::max(turn_rad, calc_turn_rad(model, qd, h_s));
        double slid_m = 0;
        for (Eigen::Index i = 0; i < q.size(); ++i) {
          slid_m += is_prismatic(model, i) ? std::abs(q[i]) : 0;
        }
        farthest_m = std::max(farthest_m, slid_m);
        worst_m = std::max(worst_m, (arm.tip_position_m() - oracle.calc(q, qd).tip_m).norm());
      }
      EXPECT_GT(fastest, 2) << "hardly moves";
      EXPECT_LT(worst_m, ArmTraits<TypeParam>::calc_gap_m(turn_rad, reach_m + farthest_m, joints,
                                                          physics.erp));
    }
  }
}

// An impulse and its opposite leave the link at rest, with a gap of r (w h)^2 / 2 at its hinge.
// Every later step corrects the share ERP of the gap. The square of the gap is neglected.
TEST(OdeArmHinges, HealByTheShareErpAStep) {
  const RobotModel model = make_pendulum({0.5, 0.8, 0.4});
  const double h_s = 0.01;
  for (const double erp : {0.25, 0.6}) {
    PhysicsSettings physics;
    physics.gravity_m_per_s2 = 0;
    physics.erp = erp;
    auto arm = make_arm<OdeArm>(model, VectorXd::Constant(1, 0.7), physics);
    const Vector3d axis = model.joints[0].axis, pivot = model.joints[0].origin.translation();
    const auto measure_radius_m = [&] {
      return (arm.com_position_m(0) - pivot).cross(axis).norm();
    };
    const double radius_m = measure_radius_m();
    step(arm, VectorXd::Constant(1, 250), h_s);
    const double turn = h_s * read_rates(arm, 1)[0];
    double off_m = measure_radius_m() - radius_m;
    EXPECT_NEAR(off_m, radius_m * turn * turn / 2, radius_m * std::pow(turn, 4));
    step(arm, VectorXd::Constant(1, -250), h_s);
    for (int k = 0; k < 5; ++k) {
      off_m = measure_radius_m() - radius_m;
      step(arm, VectorXd::Zero(1), h_s);
      EXPECT_NEAR((measure_radius_m() - radius_m) / off_m, 1 - erp, turn * turn) << "step " << k;
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
