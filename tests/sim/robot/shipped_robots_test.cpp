// The robots that come with the program.
#include <gmock/gmock.h>

#include <filesystem>
#include <vector>

#include "sim/kinematics/kinematics.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/support.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

RobotModel load_shipped(const std::string& name, const std::string& tip = "") {
  return load_urdf(std::filesystem::path(ARMWRIGHT_CONFIGS) / "robots" / (name + ".urdf"),
                   {.tip = tip});
}

// The tolerance is relative to the number, or to 1 if the number is small; the files have 9
// decimals.
void expect_same_body(const Inertial& found, const Inertial& expected) {
  constexpr double kRelative = 1e-6;
  EXPECT_NEAR(found.mass_kg, expected.mass_kg, kRelative * expected.mass_kg);
  EXPECT_LT((found.com_m - expected.com_m).norm(), kRelative * expected.com_m.norm());
  EXPECT_LT((found.inertia_kg_m2 - expected.inertia_kg_m2).norm(),
            kRelative * expected.inertia_kg_m2.norm());
}

Inertial join_links(const Link& upper, const Joint& joint, const Link& lower) {
  return combine(upper.inertial, transform(lower.inertial, joint.origin));
}

TEST(Irb4600Six, IsTheArmWithFourJointsAtZero) {
  const RobotModel six = load_shipped("irb4600_six");
  const RobotModel four = load_shipped("irb4600_40_255");
  ASSERT_EQ(six.joint_count(), 6u);
  for (std::size_t i = 0; i < 2; ++i) {
    expect_same_body(six.links[i].inertial, four.links[i].inertial);
  }
  expect_same_body(join_links(six.links[2], six.joints[3], six.links[3]), four.links[2].inertial);
  expect_same_body(join_links(six.links[4], six.joints[5], six.links[5]), four.links[3].inertial);
  // A general posture of the four joints. Tolerance: roundings of numbers of size 1.
  const std::vector<double> q{0.3, -0.4, 0.5, -0.6};
  const std::vector<double> same{0.3, -0.4, 0.5, 0, -0.6, 0};
  EXPECT_LT((calc_tip_position(six, same) - calc_tip_position(four, q)).norm(), 1e-14);
  // The axes 4 and 6 pass through the tip where the wrist is straight.
  const std::vector<double> rolled{0.3, -0.4, 0.5, 1.2, 0, -2.1}, straight{0.3, -0.4, 0.5, 0, 0, 0};
  EXPECT_LT((calc_tip_position(six, rolled) - calc_tip_position(six, straight)).norm(), 1e-14);
}

TEST(Irb4600Six, HasTheRangesAndSpeedsOfTheDataSheet) {
  const RobotModel arm = load_shipped("irb4600_six");
  const double lower_deg[] = {-180, -90, -180, -400, -125, -400};
  const double upper_deg[] = {180, 150, 75, 400, 120, 400};
  const double speed_deg_per_s[] = {175, 175, 175, 250, 250, 360};
  ASSERT_EQ(arm.joint_count(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(arm.joints[i].name, "joint_" + std::to_string(i + 1));
    EXPECT_DOUBLE_EQ(arm.joints[i].lower, lower_deg[i] * kPi / 180);
    EXPECT_DOUBLE_EQ(arm.joints[i].upper, upper_deg[i] * kPi / 180);
    EXPECT_DOUBLE_EQ(arm.joints[i].speed_limit, speed_deg_per_s[i] * kPi / 180);
    EXPECT_EQ(arm.joints[i].origin.linear(), Eigen::Matrix3d::Identity());
  }
}

TEST(ShippedRobots, HaveNothingLeftOut) {
  for (const std::string name : {"irb4600_40_255", "irb4600_six", "kr300", "planar2", "arm7"}) {
    const RobotModel robot = load_shipped(name);
    EXPECT_EQ(robot.name, name);
    EXPECT_THAT(robot.notes, IsEmpty()) << name;
    EXPECT_GT(robot.tip_pose.translation().norm(), 0) << name << " can carry a load";
    for (const Link& link : robot.links) {
      EXPECT_FALSE(link.visuals.empty()) << name << ' ' << link.name;
    }
  }
}

TEST(ShippedRobots, ThePlanarArmMovesInXAndZ) {
  const RobotModel arm = load_shipped("planar2");
  ASSERT_EQ(arm.joint_count(), 2u);
  const double a = 0.7, b = -1.1;  // positive angles lift
  const Eigen::Vector3d expected(0.5 * std::cos(a) + 0.45 * std::cos(a + b), 0,
                                 1 + 0.5 * std::sin(a) + 0.45 * std::sin(a + b));
  EXPECT_LT((calc_tip_position(arm, std::vector{a, b}) - expected).norm(), 1e-15);
}

// Three axes meet in the shoulder and three in the wrist: the elbow alone says how far the wrist is
// from the shoulder.
TEST(ShippedRobots, TheLightArmHasAShoulderAndAWrist) {
  const RobotModel arm = load_shipped("arm7");
  ASSERT_EQ(arm.joint_count(), 7u);
  const Eigen::Vector3d shoulder(0, 0, 0.31);
  EXPECT_LT((calc_tip_position(arm, std::vector<double>(7)) - shoulder - Eigen::Vector3d(0, 0, 0.9))
                .norm(),
            1e-15);
  const std::vector<double> q{0.3, 0.8, -0.5, 1.2, 2.0, -0.7, 0.4};
  const std::vector<Eigen::Isometry3d> poses = calc_link_poses(arm, q);
  const Eigen::Vector3d wrist = poses[6 - 1].translation();
  EXPECT_NEAR((wrist - shoulder).norm(),
              std::sqrt(0.4 * 0.4 + 0.38 * 0.38 + 2 * 0.4 * 0.38 * std::cos(1.2)), 1e-14);
  EXPECT_NEAR((calc_tip_position(arm, q) - wrist).norm(), 0.12, 1e-14);
  EXPECT_NEAR(calc_moving_mass_kg(arm), 19.8, 1e-12);
}

TEST(ShippedRobots, TheGripperIsPartOfTheLastLink) {
  const RobotModel proposed = load_shipped("arm7_gripper");
  EXPECT_EQ(proposed.reading.tip, "tool");
  EXPECT_THAT(proposed.reading.ends, ElementsAre("jaw_left", "jaw_right", "tool"));
  const RobotModel arm = load_shipped("arm7");
  const RobotModel gripper = load_shipped("arm7_gripper", "tool");
  ASSERT_EQ(gripper.joint_count(), 7u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(gripper.links[i].inertial.inertia_kg_m2, arm.links[i].inertial.inertia_kg_m2);
  }
  EXPECT_NEAR(calc_moving_mass_kg(gripper), 19.8 + 0.6 + 2 * 0.05, 1e-12);
  EXPECT_NEAR(gripper.links[6].inertial.com_m.y(), 0, 1e-15) << "both jaws are closed";
  EXPECT_EQ(gripper.notes.size(), 2u);
  EXPECT_NEAR(gripper.tip_pose.translation().z(), 0.06 + 0.11, 1e-15);
}

}  // namespace
}  // namespace armwright
