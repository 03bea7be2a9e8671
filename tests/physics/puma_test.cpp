// Checks rotor inertia on the PUMA 560 against computed torques and inertias of other programs. The
// arm is built in memory, because the published numbers break what the URDF reader asks of bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/tracking/tracking_setup.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {
namespace {

// One row of standard Denavit-Hartenberg parameters, and the body of the link in its own frame.
struct PumaLink {
  double d_m, a_m, alpha_deg, mass_kg;
  Vector3d com_m, moments_kg_m2;
  double motor_kg_m2, gear;
};
// Corke and Armstrong-Helouvry 1994, A search for consensus among model parameters reported for the
// PUMA 560.
const std::vector<PumaLink> kPuma = {
    {0, 0, 90, 0, {0, 0, 0}, {0, 0.35, 0}, 200e-6, 62.6111},
    {0, 0.4318, 0, 17.4, {-0.3638, 0.006, 0.2275}, {0.13, 0.524, 0.539}, 200e-6, 107.815},
    {0.15005, 0.0203, -90, 4.8, {-0.0203, -0.0141, 0.070}, {0.066, 0.086, 0.0125}, 200e-6, 53.7063},
    {0.4318, 0, 90, 0.82, {0, 0.019, 0}, {1.8e-3, 1.3e-3, 1.8e-3}, 33e-6, 76.0364},
    {0, 0, -90, 0.34, {0, 0, 0}, {0.3e-3, 0.4e-3, 0.3e-3}, 33e-6, 71.923},
    {0, 0, 0, 0.09, {0, 0, 0.032}, {0.15e-3, 0.15e-3, 0.04e-3}, 33e-6, 76.686}};

// In the standard form, joint i turns about the z axis of frame i - 1, and then
// Trans(z, d) Trans(x, a) Rot(x, alpha) leads to frame i. Bodies are given there.
RobotModel make_puma(bool has_rotors) {
  RobotModel robot;
  robot.name = "puma560";
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();  // frame i seen from joint i
  for (const PumaLink& its : kPuma) {
    Inertial body{its.mass_kg, its.com_m, its.moments_kg_m2.asDiagonal()};
    Eigen::Isometry3d end = Eigen::Isometry3d::Identity();
    end.translation() = Vector3d(its.a_m, 0, its.d_m);
    end.linear() = make_rotation(Vector3d::UnitX(), its.alpha_deg * kPi / 180);
    append_link(robot, "j" + std::to_string(robot.joint_count() + 1), Vector3d::Zero(),
                Vector3d::UnitZ(), transform(body, end));
    robot.joints.back().origin = before;
    robot.joints.back().plant.armature = has_rotors ? its.gear * its.gear * its.motor_kg_m2 : 0;
    before = end;
  }
  robot.tip_pose = before;
  return robot;
}

VectorXd make_posture() {
  return make_vector({0, 45, 180, 0, 45, 0}) * kPi / 180;
}

TEST(Puma560, GravityTorquesAreThePublishedOnes) {
  PhysicsSettings physics;
  physics.gravity_m_per_s2 = 9.81;
  const RobotModel robot = make_puma(true);
  const ArticulatedArm arm = make_arm<ArticulatedArm>(robot, make_posture(), physics);
  const double expected[] = {0, 31.63988, 6.03514, 0, 0.0282528, 0};
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(arm.calc_bias()[i], expected[i], i == 4 ? 5e-8 : 5e-6) << "joint " << i + 1;
  }
}

TEST(Puma560, RotorsAddToTheInertias) {
  const double with[] = {3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941};
  const double without[] = {2.8753, 2.0889, 0.3610, 0.0017, 0.0006, 0.0000};
  for (const bool has_rotors : {true, false}) {
    const RobotModel robot = make_puma(has_rotors);
    const ArticulatedArm arm = make_arm<ArticulatedArm>(robot, make_posture());
    for (int i = 0; i < 6; ++i) {
      // Half a unit of the last digit printed.
      EXPECT_NEAR(arm.calc_mass_matrix()(i, i), (has_rotors ? with : without)[i], 5.01e-5)
          << "joint " << i + 1;
    }
  }
}

// All joints move from 0 along 10 s^3 - 15 s^4 + 6 s^5, and feed-forward efforts are integrated.
// Iyy of link 3 is 0.0785 here, the largest that a body can have.
double calc_positive_work_j(double duration_s, bool has_rotors) {
  RobotModel robot = make_puma(has_rotors);
  const VectorXd end = make_vector({90, 45, -90, 45, 45, 90}) * kPi / 180;
  Inertial& third = robot.links[2].inertial;
  Inertial body{kPuma[2].mass_kg, kPuma[2].com_m, Vector3d(0.066, 0.0785, 0.0125).asDiagonal()};
  third = transform(body, robot.joints[3].origin);
  ArticulatedArm arm = make_arm<ArticulatedArm>(robot, VectorXd::Zero(6));
  const int steps = 4000;
  double work_j = 0;
  for (int k = 0; k < steps; ++k) {
    const double s = (k + 0.5) / steps;
    const VectorXd q = end * (s * s * s * (10 + s * (6 * s - 15)));
    const VectorXd rate = end * (30 * s * s * (1 + s * (s - 2))) / duration_s;
    const VectorXd acceleration =
        end * (60 * s * (1 + s * (2 * s - 3))) / (duration_s * duration_s);
    arm.set_state({q.data(), 6}, {rate.data(), 6});
    const VectorXd effort = arm.calc_mass_matrix() * acceleration + arm.calc_bias();
    for (int i = 0; i < 6; ++i) {
      work_j += std::max(0.0, effort[i] * rate[i]) * duration_s / steps;
    }
  }
  return work_j;
}

// The published sums are those of another program and another quadrature: 0.1 mJ.
TEST(Puma560, PositiveWorkOfAQuinticIsThePublishedOne) {
  EXPECT_NEAR(calc_positive_work_j(1, true), 53.648, 6e-4);
  EXPECT_NEAR(calc_positive_work_j(2, true), 34.782, 6e-4);
  EXPECT_NEAR(calc_positive_work_j(1, false), 47.674, 6e-4);
  EXPECT_NEAR(calc_positive_work_j(2, false), 33.445, 6e-4);
}

}  // namespace
}  // namespace armwright::physics_test
