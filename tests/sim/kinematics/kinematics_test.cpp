#include "sim/kinematics/kinematics.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "base/random.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using ::testing::HasSubstr;

// A uniformly random point of the task's sphere.
Eigen::Vector3d draw_target(RandomStream& random) {
  while (true) {
    const Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (p.norm() <= 1) {
      return Eigen::Vector3d(1.4, 0, 0.9) + 0.8 * p;
    }
  }
}

TEST(WrapAngle, StaysWithinHalfATurn) {
  EXPECT_EQ(wrap_angle(0.5), 0.5);
  EXPECT_DOUBLE_EQ(wrap_angle(kPi + 0.25), -kPi + 0.25);
  EXPECT_DOUBLE_EQ(wrap_angle(-kPi - 0.25), kPi - 0.25);
  EXPECT_NEAR(wrap_angle(20 * kPi + 0.1), 0.1, 2e-14);  // 62.9 has an epsilon of 7e-15
  EXPECT_LE(wrap_angle(3 * kPi), kPi);
  EXPECT_GE(wrap_angle(-3 * kPi), -kPi);
}

TEST(ForwardKinematics, PutsTheJointsWhereAbbsZeroPoseHasThem) {
  const std::array<double, 4> zero{};
  const auto poses = calc_link_poses(load_irb4600(), zero);
  const Eigen::Vector3d expected[] = {
      {0, 0, 0.495}, {0.175, 0, 0.495}, {0.175, 0, 1.590}, {1.445, 0, 1.765}};
  ASSERT_EQ(poses.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((poses[i].translation() - expected[i]).norm(), 1e-15)
        << i;  // a few roundings of numbers below 2
    EXPECT_EQ(poses[i].linear(), Eigen::Matrix3d::Identity()) << i;
  }
  EXPECT_LT((calc_tip_position(load_irb4600(), zero) - Eigen::Vector3d(1.580, 0, 1.765)).norm(),
            1e-15);
}

TEST(ForwardKinematics, AgreesWithExplicitRotationsInAGeneralPose) {
  const std::array<double, 4> q{0.7, -0.4, 0.9, -1.3};
  const auto turn_y = [](double angle) {
    Eigen::Matrix3d m;
    m << std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle);
    return m;
  };
  Eigen::Matrix3d turn_z;
  turn_z << std::cos(q[0]), -std::sin(q[0]), 0, std::sin(q[0]), std::cos(q[0]), 0, 0, 0, 1;
  // The three parallel axes add up.
  const Eigen::Vector3d elbow =
      Eigen::Vector3d(0.175, 0, 0) + turn_y(q[1]) * Eigen::Vector3d(0, 0, 1.095);
  const Eigen::Vector3d wrist = elbow + turn_y(q[1] + q[2]) * Eigen::Vector3d(1.270, 0, 0.175);
  const Eigen::Vector3d tip = wrist + turn_y(q[1] + q[2] + q[3]) * Eigen::Vector3d(0.135, 0, 0);
  const Eigen::Vector3d base(0, 0, 0.495);

  const RobotModel arm = load_irb4600();
  const auto poses = calc_link_poses(arm, q);
  EXPECT_LT((poses[2].translation() - base - turn_z * elbow).norm(), 2e-15);
  EXPECT_LT((poses[3].translation() - base - turn_z * wrist).norm(), 2e-15);
  EXPECT_LT((poses[3].linear() - turn_z * turn_y(q[1] + q[2] + q[3])).norm(), 2e-15);
  EXPECT_LT((calc_tip_position(arm, q) - base - turn_z * tip).norm(), 2e-15);
}

// The joint origin's own rotation and an axis that is none of the frame's.
TEST(ForwardKinematics, AgreesWithRodriguesFormulaForAnyAxisAndOrigin) {
  RobotModel robot;
  robot.joints.resize(1);
  robot.links.resize(1);
  const Eigen::Vector3d k = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  robot.joints[0].axis = k;
  robot.joints[0].origin.translation() << 0.1, 0.2, 0.3;
  robot.joints[0].origin.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
  const Eigen::Vector3d p(0.4, 0.7, -0.2);
  robot.tip_pose.translation() = p;
  const double angle = 1.1;
  const Eigen::Vector3d turned =
      p * std::cos(angle) + k.cross(p) * std::sin(angle) + k * (k.dot(p) * (1 - std::cos(angle)));
  const Eigen::Vector3d expected(0.1 - turned.y(), 0.2 + turned.x(), 0.3 + turned.z());
  EXPECT_LT((calc_tip_position(robot, std::array{angle}) - expected).norm(), 1e-15);
}

// Through the whole sphere of the task. Tolerance: some 1e-16 rad of rounding in each angle,
// magnified at most ten times by acos inside the sphere (which keeps away from the stretched arm),
// at 3 m of reach.
// A turned slider on a turned hinge: R(q1) (d + R0 (q2 a + p)), by hand with a quarter turn each.
TEST(ForwardKinematics, MovesAPrismaticJointAlongItsTurnedAxis) {
  RobotModel robot;
  robot.joints.resize(2);
  robot.links.resize(2);
  robot.joints[0].axis = Eigen::Vector3d::UnitZ();
  robot.joints[1].kind = JointKind::prismatic;
  robot.joints[1].axis = Eigen::Vector3d(0.6, 0, 0.8);
  robot.joints[1].origin.translation() << 1, 2, 3;
  robot.joints[1].origin.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
  robot.tip_pose.translation() << 0.25, 0.5, -1;
  const std::array<double, 2> q{kPi / 2, -5};
  // q2 a = (-3, 0, -4), the tip (-2.75, 0.5, -5) from the origin; turned: (-0.5, -2.75, -5); in the
  // first link's frame (0.5, -0.75, -2); turned once more: (0.75, 0.5, -2).
  EXPECT_LT((calc_tip_position(robot, q) - Eigen::Vector3d(0.75, 0.5, -2)).norm(), 4e-15);
  const auto poses = calc_link_poses(robot, q);
  // The same without the tip: (1, 2, 3) + (0, -3, -4) = (1, -1, -1), turned (1, 1, -1).
  EXPECT_LT((poses[1].translation() - Eigen::Vector3d(1, 1, -1)).norm(), 4e-15);
  EXPECT_LT((poses[1].linear() - poses[0].linear() * robot.joints[1].origin.linear()).norm(), 1e-15)
      << "a slider does not turn";
}

TEST(Displacement, IsTheShortWayRoundForRevoluteJointsOnly) {
  EXPECT_EQ(calc_displacement(JointKind::revolute, 0.25, 1.5), 1.25);
  EXPECT_NEAR(calc_displacement(JointKind::revolute, 3.1, -3.1), 2 * kPi - 6.2, 1e-15);
  EXPECT_EQ(calc_displacement(JointKind::prismatic, 0.25, 1.5), 1.25);
  EXPECT_EQ(calc_displacement(JointKind::prismatic, 3.5, -3.5), -7);
  EXPECT_EQ(calc_displacement(JointKind::prismatic, -100, 200), 300);
}

TEST(ElbowUp, ForwardUndoesInverseEverywhereInTheSphere) {
  const RobotModel arm = load_irb4600();
  const ElbowUpKinematics kinematics(arm);
  RandomStream random("test/kinematics/sphere");
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector3d target = draw_target(random);
    std::array<double, 4> q{};
    ASSERT_TRUE(kinematics.solve(target, q)) << target.transpose();
    const auto poses = calc_link_poses(arm, q);
    ASSERT_LT((poses[3] * arm.tip_pose.translation() - target).norm(), 1e-12) << target.transpose();
    ASSERT_LT((poses[3].linear().col(0) + Eigen::Vector3d::UnitZ()).norm(), 1e-12)
        << "the last link points down";

    const Eigen::Vector3d shoulder = poses[1].translation(), elbow = poses[2].translation(),
                          wrist = poses[3].translation();
    const double share =
        (elbow - shoulder).dot(wrist - shoulder) / (wrist - shoulder).squaredNorm();
    ASSERT_GT(elbow.z(), shoulder.z() + share * (wrist.z() - shoulder.z()))
        << "the elbow is above the line";
  }
}

// Targets behind the robot and at any heading, where angles change sign or wrap.
TEST(ElbowUp, ReachesTargetsAllAround) {
  const RobotModel arm = load_irb4600();
  const ElbowUpKinematics kinematics(arm);
  RandomStream random("test/kinematics/around");
  for (int i = 0; i < 1000; ++i) {
    const double heading = random.uniform(-kPi, kPi), radius = random.uniform(0.7, 2.0);
    const Eigen::Vector3d target(radius * std::cos(heading), radius * std::sin(heading),
                                 random.uniform(0.0, 1.2));
    std::array<double, 4> q{};
    ASSERT_TRUE(kinematics.solve(target, q)) << target.transpose();
    ASSERT_LT((calc_tip_position(arm, q) - target).norm(), 1e-12) << target.transpose();
  }
}

// With the thesis's error the wrist's horizontal distance is measured from a point 0.1225 m beside
// the shoulder, at a right angle to the arm's plane: sqrt(f^2 + 0.1225^2) instead of f. The heading
// is right, so the tip lands too far out by just that.
TEST(ElbowUp, TheThesissErrorLandsTooFarOut) {
  const RobotModel arm = load_irb4600();
  const ElbowUpKinematics kinematics(arm, true);
  RandomStream random("test/kinematics/bug");
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d target = draw_target(random);
    std::array<double, 4> q{};
    ASSERT_TRUE(kinematics.solve(target, q)) << target.transpose();
    const double radius = target.head<2>().norm();
    const double f = radius - 0.175;
    const double too_far = std::sqrt(f * f + 0.1225 * 0.1225) - f;
    const Eigen::Vector3d outward(target.x() / radius, target.y() / radius, 0);
    ASSERT_LT((calc_tip_position(arm, q) - target - too_far * outward).norm(), 1e-12)
        << target.transpose();
  }
  std::array<double, 4> q{};
  ASSERT_TRUE(kinematics.solve({1.4, 0, 0.9}, q));
  EXPECT_NEAR((calc_tip_position(arm, q) - Eigen::Vector3d(1.4, 0, 0.9)).norm(), 0.0061098, 1e-7)
      << "6.1 mm at the sphere's centre: sqrt(1.225^2 + 0.1225^2) - 1.225";
}

TEST(ElbowUp, SaysHowFarAnUnreachableTargetIs) {
  const ElbowUpKinematics kinematics(load_irb4600());
  std::array<double, 4> q{9, 9, 9, 9};
  // The wrist is 0.135 m above the target: f = 5 - 0.175, e = 0.36 - 0.495 + 0.135 = 0. Forearm:
  // hypot(1.27, 0.175) = 1.282.
  EXPECT_FALSE(kinematics.solve({5, 0, 0.36}, q));
  EXPECT_EQ(kinematics.describe_unreachable({5, 0, 0.36}),
            "target (5, 0, 0.36) m is out of reach: the wrist would be 4.825 m from the shoulder, "
            "possible is 0.187 to "
            "2.377 m");
  EXPECT_THAT(kinematics.describe_unreachable({900, 0, 500}),
              testing::EndsWith(" m; were millimetres meant? All lengths are in metres"));
  EXPECT_FALSE(kinematics.solve({0.2, 0, 0.36}, q)) << "too near";
  EXPECT_THAT(kinematics.describe_unreachable({0.2, 0, 0.36}),
              HasSubstr("the wrist would be 0.025 m"));
  EXPECT_FALSE(kinematics.solve({0.175, 0, 0.36}, q)) << "the wrist in the shoulder: 0 / 0";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(kinematics.solve({nan, 0, 1}, q));
  EXPECT_FALSE(kinematics.solve({1, 0, std::numeric_limits<double>::infinity()}, q));
  EXPECT_EQ(q, (std::array<double, 4>{9, 9, 9, 9})) << "untouched";
}

// Either end of the reach, just inside and just outside.
TEST(ElbowUp, ReachesExactlyAsFarAsItSays) {
  const ElbowUpKinematics kinematics(load_irb4600());
  const double a = std::hypot(1.270, 0.175), c = 1.095;
  std::array<double, 4> q{};
  for (const double off : {1e-9, -1e-9}) {
    EXPECT_EQ(kinematics.solve({0.175 + a + c + off, 0, 0.36}, q), off < 0);
    EXPECT_EQ(kinematics.solve({0.175 + a - c + off, 0, 0.36}, q), off > 0);
  }
}

// Another arm of the same kind: other lengths, bent at angle zero, two axes the other way round,
// links beside the plane.
TEST(ElbowUp, TakesItsDimensionsAndSignsFromTheModel) {
  RobotModel robot = load_irb4600();
  robot.joints[0].origin.translation() << 0, 0, 0.61;
  robot.joints[0].axis = -Eigen::Vector3d::UnitZ();
  robot.joints[1].origin.translation() << 0.31, -0.12, 0.05;
  robot.joints[2].origin.translation() << 0.22, -0.06, 0.93;
  robot.joints[2].axis = -Eigen::Vector3d::UnitY();
  robot.joints[3].origin.translation() << 0.97, 0.18, -0.21;
  robot.tip_pose.translation() << 0.11, 0, 0.08;
  const ElbowUpKinematics kinematics(robot);
  RandomStream random("test/kinematics/other arm");
  for (int i = 0; i < 1000; ++i) {
    const double heading = random.uniform(-kPi, kPi), radius = random.uniform(0.9, 1.6);
    const Eigen::Vector3d target(radius * std::cos(heading), radius * std::sin(heading),
                                 random.uniform(0.2, 1.0));
    std::array<double, 4> q{};
    ASSERT_TRUE(kinematics.solve(target, q)) << target.transpose();
    const auto poses = calc_link_poses(robot, q);
    const Eigen::Vector3d tip = poses[3] * robot.tip_pose.translation();
    ASSERT_LT((tip - target).norm(), 1e-12) << target.transpose();
    // In the arm's plane the tip is below the last joint; across it, the link's offset remains.
    const Eigen::Vector3d hanging = poses[3].translation() - tip;
    ASSERT_NEAR(hanging.z(), std::hypot(0.11, 0.08), 1e-12);
    ASSERT_LT(hanging.head<2>().norm(), 1e-12);
  }
}

std::string refusal(const std::function<void(RobotModel&)>& change) {
  RobotModel robot = load_irb4600();
  change(robot);
  try {
    const ElbowUpKinematics kinematics(robot);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    return error.what();
  }
  return "no error";
}

TEST(ElbowUp, RefusesOtherKindsOfRobots) {
  const std::string who =
      "robot 'irb4600_40_255' does not suit the closed-form inverse kinematics: ";
  EXPECT_EQ(refusal([](RobotModel& r) {
              r.joints.pop_back();
              r.links.pop_back();
            }),
            who +
                "it has 3 moving joints; it must have 4: a vertical one and three parallel "
                "horizontal ones");
  EXPECT_EQ(refusal([](RobotModel& r) { r.joints[2].kind = JointKind::prismatic; }),
            who + "joint 3 ('joint_3') is prismatic; all 4 must be revolute");
  EXPECT_EQ(refusal([](RobotModel& r) { r.joints[0].axis = Eigen::Vector3d::UnitX(); }),
            who +
                "at angle zero the axis of joint 1 ('joint_1') is (1, 0, 0) in the world frame; it "
                "must be vertical, +z "
                "or -z");
  EXPECT_EQ(refusal([](RobotModel& r) { r.joints[2].axis = Eigen::Vector3d(0.6, 0.8, 0); }),
            who +
                "at angle zero the axis of joint 3 ('joint_3') is (0.6, 0.8, 0) in the world "
                "frame; it must be +y or -y");
  EXPECT_EQ(refusal([](RobotModel& r) { r.joints[0].origin.translation().x() = 0.25; }),
            who +
                "joint 1 ('joint_1') turns about the vertical through x = 0.25, y = 0 m; it must "
                "be the z axis of the base "
                "link's frame: move that frame onto the axis");
  EXPECT_EQ(refusal([](RobotModel& r) { r.joints[3].origin.translation().y() = 0.05; }),
            who +
                "at angle zero its tip is at y = 0.05 m; the links must lead it back into the "
                "vertical plane y = 0 through "
                "the first axis");
  EXPECT_EQ(refusal([](RobotModel& r) { r.tip_pose.translation().setZero(); }),
            who + "link 'link_3' has no length: the tip lies on the axis of joint 4 ('joint_4')");
  EXPECT_EQ(refusal([](RobotModel& r) { r.joints[2].origin.translation().setZero(); }),
            who +
                "link 'link_1' has no length: joint 3 ('joint_3') lies on the axis of joint 2 "
                "('joint_2')");
}

// -0.0 and the rounding of rpy angles in a file are no reason to refuse a robot.
TEST(ElbowUp, ToleratesRounding) {
  EXPECT_EQ(refusal([](RobotModel& r) {
              r.joints[1].axis = Eigen::Vector3d(1e-8, 1, -1e-8).normalized();
              r.tip_pose.translation().y() = 1e-8;
            }),
            "no error");
}

}  // namespace
}  // namespace armwright
