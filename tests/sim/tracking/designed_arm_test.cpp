// Checks stretched links against bodies whose inertia has a closed form, motors against a
// pendulum's period, and the arm's kinematics after both.
#include "sim/tracking/designed_arm.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "base/expect_error.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/engines/ode/ode_arm.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Inertial make_box(const Vector3d& size_m, double mass_kg, const Vector3d& com_m) {
  const Vector3d s = size_m.cwiseProduct(size_m);
  return {
      mass_kg, com_m,
      Vector3d(mass_kg / 12 * Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y())).asDiagonal()};
}

// Returns an arm of one link, with the tip at its end.
RobotModel make_one_link(const Inertial& body, const Vector3d& tip_m) {
  RobotModel model;
  model.name = "one link";
  model.joints.resize(1);
  model.joints[0].axis = Vector3d::UnitY();
  model.links.push_back({"link", body, {}});
  model.tip_pose.translation() = tip_m;
  return model;
}

TEST(EffortTotals, KeepNewtonMetresAndNewtonsApart) {
  RobotModel robot;
  robot.joints.resize(3);
  robot.joints[1].kind = JointKind::prismatic;
  ArmDesign design;
  design.joints = {{{}, {-70, 50}}, {{}, {-300, 400}}, {{}, {-10, 50}}};
  const EffortTotals mixed = calc_effort_totals(design, robot);
  EXPECT_EQ(mixed.torque_n_m, 120);
  EXPECT_EQ(mixed.force_n, 400);
  EXPECT_EQ(calc_total_effort(design), 520);  // as objectives count it
  robot.joints[1].kind = JointKind::revolute;
  EXPECT_EQ(calc_effort_totals(design, robot).torque_n_m, 520);
  EXPECT_EQ(calc_effort_totals(design, robot).force_n, std::nullopt);
  for (Joint& joint : robot.joints) {
    joint.kind = JointKind::prismatic;
  }
  EXPECT_EQ(calc_effort_totals(design, robot).torque_n_m, std::nullopt);
  EXPECT_EQ(calc_effort_totals(design, robot).force_n, 520);
}

TEST(StretchedLink, OfAHomogeneousBoxIsTheLongerAndWiderBox) {
  const double length = 1.4, section = 1.7;
  const RobotModel model =
      make_one_link(make_box({0.9, 0.2, 0.3}, 12, {0.45, 0.01, -0.02}), {0.9, 0, 0});
  const RobotModel stretched = stretch_link(model, 0, length, section);
  const double wide = std::sqrt(section);
  const Inertial expected = make_box({0.9 * length, 0.2 * wide, 0.3 * wide}, 12 * length * section,
                                     {0.45 * length, 0.01 * wide, -0.02 * wide});
  const Inertial& body = stretched.links[0].inertial;
  // Some ten roundings of numbers near 10.
  EXPECT_NEAR(body.mass_kg, expected.mass_kg, 1e-13);
  EXPECT_LT((body.com_m - expected.com_m).norm(), 1e-15);
  EXPECT_LT((body.inertia_kg_m2 - expected.inertia_kg_m2).norm(), 1e-13);
  EXPECT_LT((stretched.tip_pose.translation() - Vector3d(0.9 * length, 0, 0)).norm(), 1e-15);
}

// The same box, turned in its link's frame so that its long side points to the tip.
TEST(StretchedLink, WorksAlongAnyDirection) {
  const Matrix3d turn =
      Eigen::AngleAxisd(0.8, Vector3d(0.3, -0.5, 0.9).normalized()).toRotationMatrix();
  const Inertial straight = make_box({0.9, 0.2, 0.3}, 12, {0.45, 0.01, -0.02});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn;
  const RobotModel model = make_one_link(transform(straight, pose), pose * Vector3d(0.9, 0, 0));
  const RobotModel stretched = stretch_link(model, 0, 0.7, 2.5);
  const Inertial expected = transform(
      stretch_link(make_one_link(straight, {0.9, 0, 0}), 0, 0.7, 2.5).links[0].inertial, pose);
  const Inertial& body = stretched.links[0].inertial;
  EXPECT_LT((body.com_m - expected.com_m).norm(), 1e-14);
  EXPECT_LT((body.inertia_kg_m2 - expected.inertia_kg_m2).norm(), 1e-12);
}

// The inertia of a thin rod about its end is m L^2 / 3, so it grows with the cube of the length
// scale at the same section.
TEST(StretchedLink, OfARodTurnsWithTheCubeOfItsLength) {
  const double mass_kg = 3, rod_m = 0.8;
  const Inertial rod = make_box({rod_m, 1e-9, 1e-9}, mass_kg, {rod_m / 2, 0, 0});
  const Inertial body =
      stretch_link(make_one_link(rod, {rod_m, 0, 0}), 0, 1.5, 1).links[0].inertial;
  const double about_end = body.inertia_kg_m2(1, 1) + body.mass_kg * body.com_m.squaredNorm();
  EXPECT_NEAR(about_end, std::pow(1.5, 3) * mass_kg * rod_m * rod_m / 3, 1e-13);
  EXPECT_NEAR(body.mass_kg, 4.5, 1e-15);
}

TEST(StretchedLink, OfScaleOneIsTheSameToTheLastBit) {
  const RobotModel model =
      make_one_link(make_box({0.9, 0.2, 0.3}, 12, {0.45, 0.01, -0.02}), {0.87, 0.1, 0.2});
  const RobotModel same = stretch_link(model, 0, 1, 1);
  EXPECT_EQ(same.links[0].inertial.inertia_kg_m2, model.links[0].inertial.inertia_kg_m2);
  EXPECT_EQ(same.tip_pose.translation(), model.tip_pose.translation());
}

TEST(StretchedLink, CarriesTheNextJointAlong) {
  RobotModel model = make_one_link(make_box({1, 1, 1}, 1, {0, 0, 0}), {0, 0, 0.1});
  model.joints.emplace_back();
  model.joints[1].origin.translation() = Vector3d(1.2, 0, 0.5);
  model.joints[1].origin.linear() = Eigen::AngleAxisd(0.4, Vector3d::UnitX()).toRotationMatrix();
  model.links.push_back({"second", make_box({1, 1, 1}, 2, {0, 0, 0}), {}});
  const RobotModel stretched = stretch_link(model, 0, 1.25, 2);
  EXPECT_LT((stretched.joints[1].origin.translation() - Vector3d(1.5, 0, 0.625)).norm(), 1e-15);
  EXPECT_EQ(stretched.joints[1].origin.linear(), model.joints[1].origin.linear());
  EXPECT_EQ(stretched.links[1].inertial.mass_kg, 2);
  EXPECT_EQ(stretched.tip_pose.translation(), model.tip_pose.translation());
}

TEST(StretchedLink, RefusesWhatIsNoStretching) {
  const RobotModel model = make_one_link(make_box({1, 1, 1}, 1, {0, 0, 0}), {0.5, 0, 0});
  EXPECT_EQ(usage_error_of([&] { stretch_link(model, 0, 0, 1); }),
            "link 'link' is stretched by 0; it must be finite and > 0");
  EXPECT_EQ(usage_error_of([&] { stretch_link(model, 0, 1, -2); }),
            "link 'link' is stretched by -2; it must be finite and > 0");
  const RobotModel short_one = make_one_link(make_box({1, 1, 1}, 1, {0, 0, 0}), {0, 0, 0});
  try {
    stretch_link(short_one, 0, 2, 1);
    FAIL() << "it was stretched";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    EXPECT_STREQ(error.what(),
                 "robot 'one link': link 'link' cannot be stretched: the tip lies in its own "
                 "joint, which leaves no direction");
  }
}

TEST(StretchedArm, InverseKinematicsLeadItsTipToTheTarget) {
  const RobotModel nominal =
      load_urdf(std::filesystem::path(ARMWRIGHT_CONFIGS) / "robots/irb4600_40_255.urdf");
  ArmDesign design;
  design.joints.resize(4);
  design.joints[0].length_scale = 1.3;
  design.joints[1].length_scale = 0.9;
  design.joints[1].section_scale = 2;
  design.joints[2].length_scale = 1.2;
  design.joints[3].length_scale = 1.5;
  design.joints[3].section_scale = 0.5;
  for (JointDrive& joint : design.joints) {
    joint.limits = {-300, 200};
  }
  const RobotModel robot = make_robot(nominal, design, 25);
  const ElbowUpKinematics kinematics(robot);
  EXPECT_DOUBLE_EQ(kinematics.arm().upper_arm_m, 0.9 * 1.095);
  EXPECT_DOUBLE_EQ(kinematics.arm().forearm_m, 1.2 * std::hypot(1.27, 0.175));
  for (const Vector3d& target :
       {Vector3d(1.4, 0, 0.9), Vector3d(0.9, 0.7, 1.2), Vector3d(2.1, -0.3, 0.6)}) {
    std::array<double, 4> q{};
    ASSERT_TRUE(kinematics.solve(target, q));
    EXPECT_LT((calc_tip_position(robot, q) - target).norm(), 1e-12);
  }
  std::array<double, 4> q{};
  EXPECT_FALSE(kinematics.solve({3.5, 0, 0.5}, q));
}

// A pipe's moments of inertia are those of the cylinder less those of its bore.
TEST(TubedArm, HasTheMassesOfItsTubes) {
  const RobotModel nominal = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
  ArmDesign design;
  design.joints.resize(4);
  design.joints[1].length_scale = 1.2;
  design.joints[1].tube = {0.2, 0.01};
  const TubeMaterial steel{.youngs_modulus_pa = 2e11, .density_kg_per_m3 = 7850};
  const RobotModel robot = make_robot(nominal, design, 0, steel);
  const Vector3d way = nominal.joints[2].origin.translation();
  const double length = 1.2 * way.norm();
  const double outer = 7850 * std::numbers::pi * 0.1 * 0.1 * length;
  const double bore = 7850 * std::numbers::pi * 0.09 * 0.09 * length;
  const Inertial& body = robot.links[1].inertial;
  EXPECT_NEAR(body.mass_kg, outer - bore, 1e-10);
  EXPECT_LT((body.com_m - 0.6 * way).norm(), 1e-14);
  const Vector3d axis = way.normalized(), across = way.unitOrthogonal();
  EXPECT_NEAR(axis.dot(body.inertia_kg_m2 * axis), (outer * 0.01 - bore * 0.0081) / 2, 1e-10);
  EXPECT_NEAR(across.dot(body.inertia_kg_m2 * across),
              (outer * 0.01 - bore * 0.0081) / 4 + (outer - bore) * length * length / 12, 1e-9);
  EXPECT_EQ(robot.links[2].inertial.mass_kg, nominal.links[2].inertial.mass_kg);
  EXPECT_EQ(robot.joints[2].origin.translation(), Vector3d(1.2 * way));
  EXPECT_TRUE(has_tubes(design));
  // One tube that is clamped at its joint and carries 5 kg at its end.
  RobotModel arm = make_one_link(make_box({1, 1, 1}, 1, {0, 0, 0}), {0.8, 0, 0});
  ArmDesign single;
  single.joints.resize(1);
  single.joints[0].length_scale = 1.25;
  single.joints[0].tube = {0.2, 0.01};
  const double ei = 2e11 * std::numbers::pi / 64 * (std::pow(0.2, 4) - std::pow(0.18, 4));
  const double weight = 7850 * std::numbers::pi / 4 * (0.04 - 0.0324) * 9.81;
  EXPECT_NEAR(calc_deflection_m(arm, single, steel, 5, 9.81),
              weight / (8 * ei) + 5 * 9.81 / (3 * ei), 1e-15);
}

// Returns a pendulum: a bar with a balanced wheel at its end. The wheel does not turn while the bar
// swings, so it acts as a point mass, and so does the motor of its axle.
RobotModel make_wheel_pendulum() {
  RobotModel model = make_one_link(make_box({0.05, 0.05, 0.9}, 4, {0, 0, -0.4}), Vector3d::Zero());
  model.joints.emplace_back();
  model.joints[1].axis = Vector3d::UnitY();
  model.joints[1].origin.translation() = Vector3d(0, 0, -0.8);
  model.links.push_back({"wheel", make_box({0.2, 0.1, 0.2}, 2, Vector3d::Zero()), {}});
  model.tip_pose.translation() = Vector3d(0.1, 0, 0);
  return model;
}

template <class Arm>
double measure_period_s(const RobotModel& model, double h_s) {
  const std::array<double, 2> start = {0.02, 0};
  const std::array<double, 2> none = {0, 0};
  Arm arm(model, start, PhysicsSettings{});
  std::vector<double> passes_s;
  std::array<double, 2> q = start;
  for (int k = 1; passes_s.size() < 3; ++k) {
    const double before = q[0];
    arm.step(none, h_s);
    arm.read_positions(q);
    if (before * q[0] < 0) {
      passes_s.push_back(h_s * (k - q[0] / (q[0] - before)));
    }
    if (k * h_s > 10) {
      ADD_FAILURE() << "it does not swing";
      return 0;
    }
  }
  return passes_s[2] - passes_s[0];
}

// T = 2 pi sqrt(J / (g sum of m l)), J = m (0.9^2 + 0.05^2) / 12 + m 0.4^2 + (wheel + motor) 0.8^2.
// Semi-implicit Euler's period is too short by (w h)^2 / 24 = 1e-5 and the amplitude makes it
// longer by A^2 / 16 = 2.5e-5; the motor's share of it is 1e-2.
TEST(Motor, LengthensThePeriodOfThePendulumThatCarriesIt) {
  ArmDesign design;
  design.joints.resize(2);
  design.joints[0].limits = {-5000, 5000};  // this motor stands on the base and loads no link
  design.joints[1].limits = {-60, 40};
  const double k_n_m_per_kg = 20;
  const RobotModel nominal = make_wheel_pendulum();
  const RobotModel robot = make_robot(nominal, design, k_n_m_per_kg);
  EXPECT_EQ(calc_moving_mass_kg(nominal), 6);
  EXPECT_EQ(calc_moving_mass_kg(robot), 9);
  const auto calc_period_s = [](double at_end_kg) {
    const double inertia =
        4 * (0.9 * 0.9 + 0.05 * 0.05) / 12 + 4 * 0.4 * 0.4 + at_end_kg * 0.8 * 0.8;
    const double pull = PhysicsSettings{}.gravity_m_per_s2 * (4 * 0.4 + at_end_kg * 0.8);
    return 2 * std::numbers::pi * std::sqrt(inertia / pull);
  };
  const double h_s = 0.004;
  EXPECT_NEAR(measure_period_s<ArticulatedArm>(nominal, h_s) / calc_period_s(2), 1, 1e-4);
  EXPECT_NEAR(measure_period_s<ArticulatedArm>(robot, h_s) / calc_period_s(5), 1, 1e-4);
  EXPECT_NEAR(measure_period_s<OdeArm>(robot, h_s) / calc_period_s(5), 1, 1e-4);
  EXPECT_GT(calc_period_s(5) / calc_period_s(2), 1.01);
}

}  // namespace
}  // namespace armwright
