#include "sim/motion/time_optimal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "line_arm.hpp"

namespace armwright {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

double find_time(double gravity, std::size_t intervals, std::vector<double> efforts) {
  const std::vector<double> none(3, kNoLimit);
  const LeastTime least =
      calc_least_time(make_line_arm(), gravity, sample_path(find_line_postures(intervals)),
                      {none, none, none, std::move(efforts)});
  EXPECT_FALSE(least.stuck_place);
  return least.duration_s;
}

// Computed with numpy by another implementation of the same method (the facts print four and five
// digits).
TEST(TimeOptimal, LineTakesTheOraclesTime) {
  EXPECT_NEAR(find_time(9.80665, 100, {10, 12, 4}), 0.4149, 5e-5);
  EXPECT_NEAR(find_time(9.80665, 200, {10, 12, 4}), 0.4143, 5e-5);
  EXPECT_NEAR(find_time(9.80665, 400, {10, 12, 4}), 0.4140, 5e-5);
  EXPECT_NEAR(find_time(0, 200, {10, 12, 4}), 0.36652, 5e-6);
}

// Without gravity, efforts are proportional to the square of the speed.
TEST(TimeOptimal, TimeFallsWithTheRootOfTheLimitsWithoutGravity) {
  const double time = find_time(0, 200, {10, 20, 10});
  EXPECT_NEAR(time, 0.364547, 1e-6);
  for (const double k : {2.0, 3.0, 4.0}) {
    EXPECT_NEAR(find_time(0, 200, {10 * k, 20 * k, 10 * k}) * std::sqrt(k) / time, 1, 1e-9) << k;
  }
}

// A single joint without gravity accelerates for one half and brakes for the other: T = 2 sqrt(D I /
// tau); with a speed limit, T = D / v + v I / tau. The grid of 400 places costs up to 1 / 400.
TEST(TimeOptimal, OneJointAcceleratesAndBrakes) {
  RobotModel robot;
  robot.joints.resize(1);
  robot.links.resize(1);
  robot.links[0].inertial.mass_kg = 1;
  robot.links[0].inertial.inertia_kg_m2 = 0.5 * Eigen::Matrix3d::Identity();
  const auto path = sample_path(Eigen::RowVectorXd::LinSpaced(401, 0, 2));
  JointLimits limits{{kNoLimit}, {kNoLimit}, {kNoLimit}, {3}};
  EXPECT_NEAR(calc_least_time(robot, 0, path, limits).duration_s, 2 * std::sqrt(2 * 0.5 / 3), 1e-3);
  limits.speed = {0.8};
  EXPECT_NEAR(calc_least_time(robot, 0, path, limits).duration_s, 2 / 0.8 + 0.8 * 0.5 / 3, 5e-3);
  limits.speed = {kNoLimit};
  limits.effort = {kNoLimit};
  limits.acceleration = {6};  // as the effort of 3 above
  EXPECT_NEAR(calc_least_time(robot, 0, path, limits).duration_s, 2 * std::sqrt(2 * 0.5 / 3), 1e-3);
}

TEST(TimeOptimal, NamesThePlaceAndTheJointThatCannotHoldTheArm) {
  const std::vector<double> none(3, kNoLimit);
  const LeastTime least =
      calc_least_time(make_line_arm(), 9.80665, sample_path(find_line_postures(100)),
                      {none, none, none, {10, 5, 4}});
  ASSERT_TRUE(least.stuck_place);
  EXPECT_EQ(least.stuck_joint, 1u);
  EXPECT_EQ(least.duration_s, 0);
}

}  // namespace
}  // namespace armwright
