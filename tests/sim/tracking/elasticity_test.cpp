// The fastest swing of elastic joints against closed forms, and the substeps that it needs.
#include "sim/tracking/elasticity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace armwright {
namespace {

constexpr double kArmature = 0.3, kStiffness = 4000;

// Returns an arm of one joint about y with a link of 2 kg, 0.5 m from the joint.
RobotModel make_one_link(double damping) {
  RobotModel arm;
  arm.joints.resize(1);
  arm.joints[0].axis = Eigen::Vector3d::UnitY();
  arm.joints[0].lower = -1;
  arm.joints[0].upper = 1;
  arm.joints[0].plant.armature = kArmature;
  arm.joints[0].plant.stiffness = kStiffness;
  arm.joints[0].plant.damping = damping;
  arm.links.resize(1);
  arm.links[0].inertial = {2, Eigen::Vector3d(0.5, 0, 0),
                           Eigen::Vector3d(0.01, 0.02, 0.025).asDiagonal()};
  return arm;
}
constexpr double kMoved = 0.02 + 2 * 0.5 * 0.5;  // kg m^2, about the joint
// Some ten roundings.
constexpr double kEigenvalueError = 1e-14;

TEST(FastestMode, OfOneJointIsTheClosedForm) {
  const double rate = std::sqrt(kStiffness * (1 / kArmature + 1 / kMoved));
  const auto mode = find_fastest_mode(make_one_link(1));
  ASSERT_TRUE(mode);
  EXPECT_EQ(mode->joint, 0u);
  EXPECT_NEAR(mode->rate_rad_per_s, rate, kEigenvalueError * rate);
}

// A damping of z decays at z (1 / A + 1 / M), which exceeds the swing's rate.
TEST(FastestMode, OfAStronglyDampedJointIsItsDecay) {
  const double decay = 200 * (1 / kArmature + 1 / kMoved);
  ASSERT_GT(decay, std::sqrt(kStiffness * (1 / kArmature + 1 / kMoved)));
  const auto mode = find_fastest_mode(make_one_link(200));
  ASSERT_TRUE(mode);
  EXPECT_NEAR(mode->rate_rad_per_s, decay, kEigenvalueError * decay);
}

TEST(FastestMode, IsAbsentInARigidArmAndNamesTheElasticJoint) {
  RobotModel arm = make_one_link(1);
  arm.joints[0].plant.stiffness = 0;
  EXPECT_FALSE(find_fastest_mode(arm));
  arm.joints.push_back(make_one_link(1).joints[0]);
  arm.joints[1].origin.translation() = Eigen::Vector3d(1, 0, 0);
  arm.links.push_back(arm.links[0]);
  const auto mode = find_fastest_mode(arm);
  ASSERT_TRUE(mode);
  EXPECT_EQ(mode->joint, 1u);
}

TEST(Substeps, KeepTheTurnPerStepBelowItsLimit) {
  EXPECT_EQ(count_substeps({100, 0}, 0.01), 2);  // 1 rad per period, 0.5 rad per step
  EXPECT_EQ(count_substeps({101, 0}, 0.01), 3);
  EXPECT_EQ(count_substeps({1, 0}, 0.01), 1);
  EXPECT_EQ(count_substeps({1e30, 0}, 0.01), 1'000'000'000);
}

}  // namespace
}  // namespace armwright
