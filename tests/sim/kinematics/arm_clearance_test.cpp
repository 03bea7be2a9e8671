#include "sim/kinematics/arm_clearance.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using Eigen::Vector3d;

Vector3d draw_vector(RandomStream& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

// The signed distance of a point from an obstacle, written out on its own.
double find_point_distance(const Vector3d& p, const Obstacle& obstacle) {
  if (obstacle.kind == ObstacleKind::box) {
    const Vector3d seen = obstacle.pose.inverse() * p;
    double outside = 0, inside = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const double beyond = std::abs(seen[i]) - obstacle.half_m[i];
      outside += beyond > 0 ? beyond * beyond : 0;
      inside = std::max(inside, beyond);
    }
    return outside > 0 ? std::sqrt(outside) : inside;
  }
  if (obstacle.kind == ObstacleKind::cylinder) {
    const Vector3d seen = obstacle.pose.inverse() * p;
    const double beside = std::hypot(seen.x(), seen.y()) - obstacle.half_m.x();
    const double above = std::abs(seen.z()) - obstacle.half_m.z();
    return beside <= 0 || above <= 0 ? std::max(beside, above) : std::hypot(beside, above);
  }
  const Vector3d way = obstacle.capsule.to_m - obstacle.capsule.from_m;
  double nearest = std::numeric_limits<double>::infinity();
  constexpr int kParts = 2000;
  for (int k = 0; k <= kParts; ++k) {
    nearest = std::min(nearest, (p - obstacle.capsule.from_m - way * k / kParts).norm());
  }
  return nearest - obstacle.capsule.radius_m;
}

// Dense samples of the capsule's axis find the same distance, within half the distance of samples.
TEST(ObstacleDistance, IsThatOfDenseSamples) {
  RandomStream random("test/obstacles", 1);
  for (int round = 0; round < 60; ++round) {
    for (const ObstacleKind kind :
         {ObstacleKind::sphere, ObstacleKind::capsule, ObstacleKind::box, ObstacleKind::cylinder}) {
      Obstacle obstacle;
      obstacle.kind = kind;
      obstacle.capsule.from_m = draw_vector(random, 1);
      obstacle.capsule.to_m =
          kind == ObstacleKind::sphere ? obstacle.capsule.from_m : draw_vector(random, 1);
      obstacle.capsule.radius_m = 0.2;
      obstacle.pose.translation() = draw_vector(random, 1);
      obstacle.half_m = {0.3, kind == ObstacleKind::box ? 0.2 : 0.3, 0.5};
      if (kind == ObstacleKind::box || kind == ObstacleKind::cylinder) {
        obstacle.pose.linear() =
            Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), draw_vector(random, 1))
                .toRotationMatrix();
      }
      const Capsule capsule{draw_vector(random, 1.5), draw_vector(random, 1.5), 0.1};
      const Vector3d way = capsule.to_m - capsule.from_m;
      double sampled = std::numeric_limits<double>::infinity();
      constexpr int kParts = 1000;
      for (int k = 0; k <= kParts; ++k) {
        sampled =
            std::min(sampled, find_point_distance(capsule.from_m + way * k / kParts, obstacle));
      }
      const double found = calc_distance_m(capsule, obstacle);
      EXPECT_LE(found, sampled - 0.1 + 1e-9) << static_cast<int>(kind);
      EXPECT_GE(found, sampled - 0.1 - 2.6 * way.norm() / kParts) << static_cast<int>(kind);
    }
  }
}

TEST(ObstacleDistance, OfCrossingAndParallelSegmentsIsExact) {
  EXPECT_EQ(calc_segment_distance_m({{-1, 0, 0}, {1, 0, 0}, 0}, {{0, -1, 0}, {0, 1, 0}, 0}), 0);
  EXPECT_EQ(calc_segment_distance_m({{0, 0, 0}, {1, 0, 0}, 0}, {{3, 2, 0}, {5, 2, 0}, 0}),
            std::hypot(2, 2));
  EXPECT_EQ(calc_segment_distance_m({{0, 0, 0}, {1, 0, 0}, 0}, {{0.5, 2, 0}, {5, 2, 0}, 0}), 2);
  EXPECT_EQ(calc_segment_distance_m({{0, 0, 0}, {0, 0, 0}, 0}, {{1, 0, 0}, {1, 0, 0}, 0}), 1);
}

TEST(CapsuleFit, HoldsEveryPointAndIsTightForACapsule) {
  RandomStream random("test/capsules", 2);
  const Capsule made{{0.1, -0.2, 0.3}, {0.4, 0.5, 0.1}, 0.07};
  std::vector<Vector3d> points;
  for (int k = 0; k < 3000; ++k) {
    const Vector3d middle = made.from_m + random.uniform(0, 1) * (made.to_m - made.from_m);
    points.push_back(middle + 0.07 * draw_vector(random, 1).normalized());
  }
  const Capsule fitted = fit_capsule(points, {});
  for (const Vector3d& point : points) {
    EXPECT_LE(calc_segment_distance_m(fitted, {point, point, 0}), fitted.radius_m + 1e-12);
  }
  // Random points on the surface leave gaps of a few per cent of the radius.
  EXPECT_NEAR(fitted.radius_m, 0.07, 0.007);
  EXPECT_NEAR((fitted.to_m - fitted.from_m).norm(), (made.to_m - made.from_m).norm(), 0.03);
}

TEST(ArmClearance, NamesTheNearestLinkAndObstacle) {
  const RobotModel robot = load_irb4600();
  std::vector<std::string> notes;
  const auto capsules = fit_link_capsules(robot, MeshFinder("."), notes);
  Obstacle far{
      .name = "far", .kind = ObstacleKind::sphere, .capsule = {}, .pose = {}, .half_m = {}};
  far.capsule = {{0, 30, 0}, {0, 30, 0}, 0.1};
  Obstacle near = far;
  near.name = "near";
  const std::vector<double> q(4, 0);
  const auto poses = calc_link_poses(robot, q);
  const Vector3d tip = poses.back() * robot.tip_pose.translation();
  near.capsule.from_m = near.capsule.to_m = tip + Vector3d(0.5, 0, 0);
  const ArmClearance clearance(robot, capsules, {far, near}, false);
  const auto nearest = clearance.find_nearest(poses);
  EXPECT_TRUE(nearest.is_obstacle);
  EXPECT_EQ(nearest.other, 1u);
  EXPECT_LT(nearest.distance_m, 0.5 - 0.1);
  EXPECT_GT(nearest.distance_m, 0);
  EXPECT_THAT(clearance.describe(nearest), ::testing::HasSubstr("obstacle 'near'"));
  // An obstacle around a link is inside it: the distance is negative.
  near.capsule.from_m = near.capsule.to_m = poses[2].translation() + Vector3d(0.6, 0, 0.1);
  EXPECT_LT(ArmClearance(robot, capsules, {near}, false).find_nearest(poses).distance_m, 0);
}

TEST(ArmClearance, OfAnArmFoldedOntoItselfIsNegative) {
  RobotModel robot;
  robot.joints.resize(3);
  robot.links.resize(3);
  for (std::size_t i = 1; i < 3; ++i) {
    robot.joints[i].origin.translation() = Vector3d(1, 0, 0);
  }
  robot.tip_pose.translation() = Vector3d(1, 0, 0);
  std::vector<std::string> notes;
  const ArmClearance clearance(robot, fit_link_capsules(robot, MeshFinder("."), notes), {}, true);
  ASSERT_EQ(notes.size(), 1u);
  // Stretched, the ends of the first and the third link are 1 m apart; the radius is 5 % of 3 m.
  const std::vector<double> straight{0, 0, 0}, folded{0, 2.3, 2.3};
  EXPECT_NEAR(clearance.find_nearest(calc_link_poses(robot, straight)).distance_m, 1 - 0.3, 1e-12);
  const auto nearest = clearance.find_nearest(calc_link_poses(robot, folded));
  EXPECT_FALSE(nearest.is_obstacle);
  EXPECT_LT(nearest.distance_m, 0);
}

}  // namespace
}  // namespace armwright
