#include "sim/kinematics/tool_task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.hpp"

namespace armwright {
namespace {

Eigen::Matrix3d draw_turn(RandomStream& random) {
  Eigen::Vector4d coefficients;
  for (double& one : coefficients) {
    one = random.normal();
  }
  return Eigen::Quaterniond(coefficients.normalized()).toRotationMatrix();
}

// The mean squared distance of the tool points of two poses.
double calc_points_error(const ToolTask& tool, const ToolPose& is, const ToolPose& should) {
  double sum = 0;
  const auto points_m = make_tool_points(tool);
  for (const Eigen::Vector3d& point_m : points_m) {
    sum += (is.position_m + is.turn * point_m - should.position_m - should.turn * point_m)
               .squaredNorm();
  }
  return sum / static_cast<double>(points_m.size());
}

// The formulas of the header, for any two poses.
TEST(ToolTask, ToolPointsMeasureTheDistanceOfPoses) {
  RandomStream random("test/tool", 0);
  for (int i = 0; i < 50; ++i) {
    const ToolPose is{{random.normal(), random.normal(), random.normal()}, draw_turn(random)};
    ToolPose should{{random.normal(), random.normal(), random.normal()}, draw_turn(random)};
    ToolTask tool;
    tool.arm_m = random.uniform(0.05, 0.5);
    const double apart = (is.position_m - should.position_m).squaredNorm();
    tool.orientation = ToolOrientation::pose;
    const double angle =
        Eigen::AngleAxisd(Eigen::Matrix3d(is.turn.transpose() * should.turn)).angle();
    EXPECT_NEAR(calc_points_error(tool, is, should),
                apart + std::pow(2 * tool.arm_m * std::sin(angle / 2), 2), 1e-12);
    tool.orientation = ToolOrientation::pointing;
    tool.axis = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const double across = (is.turn * tool.axis - should.turn * tool.axis).squaredNorm();
    EXPECT_NEAR(calc_points_error(tool, is, should), apart + tool.arm_m * tool.arm_m * across,
                1e-12);
    // A turn about the axis that points is free.
    should.turn = Eigen::AngleAxisd(1.3, is.turn * tool.axis).toRotationMatrix() * is.turn;
    EXPECT_NEAR(calc_points_error(tool, is, should), apart, 1e-12);
  }
  EXPECT_TRUE(make_tool_points({}).empty());
}

TEST(ToolTask, RollPitchYawThereAndBack) {
  RandomStream random("test/rpy", 0);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d turn = draw_turn(random);
    EXPECT_LT((make_turn(calc_rpy(turn)) - turn).norm(), 1e-12);
  }
  const Eigen::Vector3d up(0, -std::numbers::pi / 2, 0.7);
  EXPECT_LT((make_turn(calc_rpy(make_turn(up))) - make_turn(up)).norm(), 1e-9);
  // Rz Ry Rx: roll first, about the fixed x axis.
  EXPECT_LT((make_turn({std::numbers::pi / 2, 0, std::numbers::pi / 2}) * Eigen::Vector3d(0, 1, 0) -
             Eigen::Vector3d(0, 0, 1))
                .norm(),
            1e-15);
}

}  // namespace
}  // namespace armwright
