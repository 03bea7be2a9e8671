#include "sim/kinematics/numeric_kinematics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/decompositions.hpp"
#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "sim/generated_arm.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

RobotModel make_arm(int number) {
  return parse_urdf(make_arm_urdf(number), "generated");
}

ToolTask make_tool(ToolOrientation orientation) {
  ToolTask tool;
  tool.orientation = orientation;
  tool.axis = Eigen::Vector3d(0.1, 0.3, 0.9).normalized();
  return tool;
}

ToolOrientation find_most(int joints) {
  return joints >= 6   ? ToolOrientation::pose
         : joints == 5 ? ToolOrientation::pointing
                       : ToolOrientation::free;
}

class GeneratedArms : public testing::TestWithParam<int> {
 protected:
  RobotModel robot_ = make_arm(GetParam());
  ToolTask tool_ = make_tool(find_most(static_cast<int>(robot_.joint_count())));
};

TEST_P(GeneratedArms, PosesAreThoseOfTheOrdinaryForwardKinematics) {
  const NumericKinematics kinematics(robot_, tool_, {}, true);
  RandomStream random("test", 1);
  for (int i = 0; i < 20; ++i) {
    const std::vector<double> q = kinematics.draw_posture(random);
    const ToolPose pose = kinematics.calc_pose(q);
    const Eigen::Isometry3d expected = calc_link_poses(robot_, q).back() * robot_.tip_pose;
    EXPECT_LT((pose.position_m - expected.translation()).norm(), 1e-13);
    EXPECT_LT((pose.turn - expected.linear()).norm(), 1e-13);
  }
}

// Every column against central differences of the poses.
TEST_P(GeneratedArms, TheJacobianIsTheDerivativeOfThePose) {
  const NumericKinematics kinematics(robot_, tool_, {}, true);
  RandomStream random("test", 2);
  const std::vector<double> q = kinematics.draw_posture(random);
  const auto jacobian = kinematics.calc_jacobian(q);
  constexpr double kStep = 1e-6;
  const ToolPose here = kinematics.calc_pose(q);
  for (std::size_t i = 0; i < q.size(); ++i) {
    std::vector<double> up = q, down = q;
    up[i] += kStep;
    down[i] -= kStep;
    const ToolPose above = kinematics.calc_pose(up), below = kinematics.calc_pose(down);
    const Eigen::Vector3d way = (above.position_m - below.position_m) / (2 * kStep);
    EXPECT_LT((jacobian.col(static_cast<Eigen::Index>(i)).head<3>() - way).norm(), 1e-8);
    // Of the rotation: the skew part of (R+ - R-) R^T / 2h.
    const Eigen::Matrix3d rate = (above.turn - below.turn) / (2 * kStep) * here.turn.transpose();
    Eigen::Vector3d spin(rate(2, 1), rate(0, 2), rate(1, 0));
    if (tool_.orientation == ToolOrientation::free) {
      spin.setZero();
    } else if (tool_.orientation == ToolOrientation::pointing) {
      const Eigen::Vector3d axis = here.turn * tool_.axis;
      spin -= spin.dot(axis) * axis;
    }
    EXPECT_LT((jacobian.col(static_cast<Eigen::Index>(i)).tail<3>() - tool_.arm_m * spin).norm(),
              1e-8);
  }
}

// Finds, without a start posture, a pose that some posture within the ranges has.
TEST_P(GeneratedArms, FindsPosesOfPosturesOffSingularities) {
  const NumericKinematics kinematics(robot_, tool_, {}, true);
  RandomStream random("test", 3);
  int tried = 0;
  for (int i = 0; i < 20; ++i) {
    const std::vector<double> q = kinematics.draw_posture(random);
    if (kinematics.calc_dexterity(q) < 0.03) {
      continue;
    }
    ++tried;
    const ToolPose target = kinematics.calc_pose(q);
    std::vector<double> found(q.size());
    ASSERT_TRUE(kinematics.find(target, found)) << "posture " << i;
    EXPECT_LT(kinematics.calc_distance(target, found), 1e-9);
    for (std::size_t joint = 0; joint < found.size(); ++joint) {
      EXPECT_GE(found[joint], robot_.joints[joint].lower);
      EXPECT_LE(found[joint], robot_.joints[joint].upper);
    }
  }
  EXPECT_GT(tried, 5);
}

INSTANTIATE_TEST_SUITE_P(Numeric, GeneratedArms, testing::Range(0, kGeneratedArms));

// In a redundant arm, joints that the task leaves free move to the middle of their ranges as far as
// the task allows. No motion that keeps the pose brings them closer.
TEST(NumericKinematics, WhatTheTaskLeavesFreeGoesToTheMiddle) {
  const RobotModel robot = make_arm(4);  // seven joints
  ASSERT_EQ(robot.joint_count(), 7U);
  const NumericKinematics kinematics(robot, make_tool(ToolOrientation::pose), {}, true);
  RandomStream random("test", 4);
  std::vector<double> q;
  do {
    q = kinematics.draw_posture(random);
  } while (kinematics.calc_dexterity(q) < 0.05);
  std::vector<double> found(7);
  ASSERT_TRUE(kinematics.find(kinematics.calc_pose(q), found));
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(kinematics.calc_jacobian(found)),
                                              Eigen::ComputeFullV);
  const Eigen::VectorXd idle = svd.matrixV().col(6);
  double pull = 0;
  bool at_an_end = false;
  for (int i = 0; i < 7; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    pull += idle[i] * (kinematics.get_middle(joint) - found[joint]);
    at_an_end |= found[joint] < robot.joints[joint].lower + 1e-9 ||
                 found[joint] > robot.joints[joint].upper - 1e-9;
  }
  EXPECT_TRUE(at_an_end || std::abs(pull) < 1e-5) << pull;
}

// The path to the target passes the end of a joint's range. The joint is held there and the others
// continue. If they cannot reach the target, it is out of reach; without limits it is reached.
TEST(NumericKinematics, JointsKeepToTheirRanges) {
  RobotModel robot = make_arm(0);  // three joints: one way to reach a point
  const NumericKinematics free(robot, {}, {}, false);
  const std::vector<double> q = {0.5, 0.6, 0.7};
  const ToolPose target = free.calc_pose(q);
  robot.joints[0].upper = 0.4;
  robot.joints[1].upper = 0.5;
  robot.joints[2].lower = -0.1;
  const NumericKinematics narrow(robot, {}, {0.3, 0.4, 0.5}, true);
  std::vector<double> found = {0.3, 0.4, 0.5};
  const std::vector<double> wish(3, 0.0);
  EXPECT_FALSE(narrow.follow(target, wish, found));
  EXPECT_LE(found[0], 0.4);
  EXPECT_LE(found[1], 0.5);
  found = {0.3, 0.4, 0.5};
  const NumericKinematics wide(robot, {}, {0.3, 0.4, 0.5}, false);
  ASSERT_TRUE(wide.follow(target, wish, found));
  EXPECT_NEAR(found[0], 0.5, 1e-7);
}

TEST(NumericKinematics, FarAwayIsOutOfReach) {
  const RobotModel robot = make_arm(3);
  const NumericKinematics kinematics(robot, make_tool(ToolOrientation::pose), {}, true);
  std::vector<double> q(robot.joint_count());
  EXPECT_FALSE(kinematics.find({{10, 0, 0}, Eigen::Matrix3d::Identity()}, q));
}

TEST(NumericKinematics, RefusesWhatTheJointsCannotDo) {
  const RobotModel three = make_arm(0);
  EXPECT_THAT(
      error_of(
          ErrorKind::bad_data,
          [&] {
            NumericKinematics(three, make_tool(ToolOrientation::pose), {}, true).check_task(three);
          }),
      testing::HasSubstr(
          "move its tool in 3 independent directions at most, but task.orientation = "
          "\"pose\" tracks the position and orientation of the tool, 6 in all"));
  EXPECT_THAT(usage_error_of([&] {
                NumericKinematics(three, {}, {0.0, 0.0}, true);
              }),
              testing::HasSubstr("task.home has 2 positions for the 3 joints"));
}

// The tool points straight down. Any turn about its axis is allowed, and the search leaves the
// opposite direction.
TEST(NumericKinematics, PointsTheToolFromTheOppositeDirection) {
  const RobotModel robot = make_arm(3);
  ToolTask tool = make_tool(ToolOrientation::pointing);
  const NumericKinematics kinematics(robot, tool, {}, true);
  RandomStream random("test", 5);
  const std::vector<double> q = kinematics.draw_posture(random);
  ToolPose target = kinematics.calc_pose(q);
  // The tool's frame upside down about an axis across the one that counts.
  const Eigen::Vector3d across = (target.turn * tool.axis).unitOrthogonal();
  target.turn = Eigen::AngleAxisd(std::numbers::pi, across).toRotationMatrix() * target.turn;
  EXPECT_NEAR(kinematics.calc_distance(target, q), tool.arm_m * std::numbers::pi, 1e-9);
}

}  // namespace
}  // namespace armwright
