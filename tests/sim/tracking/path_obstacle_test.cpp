// Obstacles on the paths of a gantry, whose distances can be computed by hand.
#include <gmock/gmock.h>

#include <cmath>
#include <memory>

#include "base/random.hpp"
#include "sim/support.hpp"
#include "sim/tracking/designed_arm.hpp"
#include "sim/tracking/path_check.hpp"

namespace armwright {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// A carriage along y that carries an arm of 0.3 m along x, which slides along x.
RobotModel make_gantry() {
  RobotModel robot;
  robot.name = "gantry";
  robot.base.name = "rail";
  robot.joints.resize(2);
  for (Joint& joint : robot.joints) {
    joint.kind = JointKind::prismatic;
    joint.lower = -1;
    joint.upper = 1;
    joint.speed_limit = 2;
    joint.effort_limit = 1000;
  }
  robot.joints[0].name = "y";
  robot.joints[0].axis = Vector3d::UnitY();
  robot.joints[1].name = "x";
  robot.joints[1].axis = Vector3d::UnitX();
  const Inertial body{1, Vector3d::Zero(), 0.01 * Eigen::Matrix3d::Identity()};
  robot.links = {{"carriage", body, {}}, {"boom", body, {}}};
  robot.tip_pose.translation() = Vector3d(0.3, 0, 0);
  return robot;
}

// The boom is 20 mm thick around its axis.
std::shared_ptr<const ArmClearance> make_boom_clearance(std::vector<Obstacle> obstacles) {
  return std::make_shared<const ArmClearance>(
      make_gantry(),
      std::vector<std::optional<Capsule>>{std::nullopt, std::nullopt,
                                          Capsule{Vector3d::Zero(), Vector3d(0.3, 0, 0), 0.02}},
      std::move(obstacles), false);
}

Obstacle make_post(double x, double y) {
  Obstacle post;
  post.name = "post";
  post.kind = ObstacleKind::cylinder;
  post.pose.translation() = Vector3d(x, y, 0);
  post.half_m = {0.05, 0.05, 0.5};
  return post;
}

TrackingTask make_gantry_task() {
  TrackingTask task;
  task.limits = LimitPolicy::warn;
  task.distance_limit_m = 0;
  task.speed_m_per_s = 0.4;
  return task;
}

TestCase make_way() {
  TestCase its;
  its.points_m = {{0.5, 0.6, 0}, {0.6, 0.6, 0}, {0.6, -0.4, 0}};
  return its;
}

std::vector<PathFault> find_faults(const TrackingTask& task, TargetTable* kept = nullptr) {
  const TrackingSetup setup(make_gantry(), task);
  const TargetTable table = setup.make_targets(make_way());
  EXPECT_EQ(table.unreachable, "");
  if (kept != nullptr) {
    *kept = table;
  }
  return find_path_faults(setup, table);
}

TEST(PathObstacle, OnTheLineIsFoundWithItsPointTimeAndLink) {
  TrackingTask task = make_gantry_task();
  EXPECT_THAT(find_faults(task), testing::IsEmpty());
  task.clearance = make_boom_clearance({make_post(0.5, 0.1)});
  TargetTable table;
  const std::vector<PathFault> faults = find_faults(task, &table);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, PathFault::Kind::obstacle);
  EXPECT_EQ(faults[0].point, 2u);
  EXPECT_EQ(faults[0].joint, 1u);
  // The boom passes through the post's axis when the carriage is nearest to y = 0.1.
  int nearest = 0;
  for (int step = 0; step < table.steps; ++step) {
    if (std::abs(table.positions(step)[0] - 0.1) < std::abs(table.positions(nearest)[0] - 0.1)) {
      nearest = step;
    }
  }
  EXPECT_DOUBLE_EQ(faults[0].time_s, (nearest + 1) * task.control_period_s);
  // An axis through the post's axis is as deep inside as both radii; off it, by the distance less.
  EXPECT_NEAR(faults[0].value, std::abs(table.positions(nearest)[0] - 0.1) - 0.07, 1e-9);
  const std::string text = describe(faults[0], make_gantry());
  EXPECT_THAT(text, HasSubstr("on the way to point 2: link 2 ('boom') would be 0.0"));
  EXPECT_THAT(text, HasSubstr(" m inside the obstacle 'post' (at "));
}

TEST(PathObstacle, NearTheLineIsFoundIfTheTaskAsksForMore) {
  TrackingTask task = make_gantry_task();
  // The tip passes at x = 0.6, the post begins 30 mm beyond the boom's end.
  task.clearance = make_boom_clearance({make_post(0.6 + 0.02 + 0.03 + 0.05, 0.1)});
  EXPECT_THAT(find_faults(task), testing::IsEmpty());
  task.clearance_m = 0.04;
  const std::vector<PathFault> faults = find_faults(task);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NEAR(faults[0].value, 0.03, 1e-3);  // a step is up to 10 mm beside the nearest place
  EXPECT_THAT(describe(faults[0], make_gantry()),
              HasSubstr("m away from the obstacle 'post' (at "));
  EXPECT_THAT(describe(faults[0], make_gantry()),
              HasSubstr("), at least 0.04 m between them are needed (task.clearance_m)"));
}

TEST(PathObstacle, AroundTheStartIsFoundAtTheStart) {
  TrackingTask task = make_gantry_task();
  // The boom begins at x = 0.2, 40 mm from the post's axis, and slides away from it.
  task.clearance = make_boom_clearance({make_post(0.16, 0.6)});
  const std::vector<PathFault> faults = find_faults(task);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].point, 1u);
  EXPECT_EQ(faults[0].time_s, 0);
  EXPECT_NEAR(faults[0].value, 0.04 - 0.07, 1e-9);
}

TEST(PathObstacle, OutOfReachChangesNoBitOfTargetsAndNoFault) {
  TrackingTask task = make_gantry_task();
  task.speed_m_per_s = 5;  // so that there are faults of speed
  TrackingTask other = task;
  other.clearance = make_boom_clearance({make_post(9, 9)});
  TargetTable a, b;
  const std::vector<PathFault> none = find_faults(task, &a), far = find_faults(other, &b);
  EXPECT_EQ(a.joint_positions, b.joint_positions);
  ASSERT_GT(none.size(), 0u);
  ASSERT_EQ(none.size(), far.size());
  for (std::size_t i = 0; i < none.size(); ++i) {
    EXPECT_EQ(describe(none[i], make_gantry()), describe(far[i], make_gantry()));
  }
}

TEST(PathObstacle, MakesACaseUnreachableIfLimitsAreEnforced) {
  TrackingTask task = make_gantry_task();
  task.limits = LimitPolicy::enforce;
  task.clearance = make_boom_clearance({make_post(0.5, 0.1)});
  EXPECT_THAT(TrackingSetup(make_gantry(), task).make_targets(make_way()).unreachable,
              HasSubstr("inside the obstacle 'post'"));
}

// Every point of a link's capsule lies, stretched, in the capsule of the stretched link.
TEST(StretchedClearance, HoldsTheStretchedCapsules) {
  const auto nominal = make_boom_clearance({});
  RandomStream random("test/stretched capsules", 0);
  for (const auto& [length, section] :
       {std::pair{1.5, 1.0}, std::pair{0.7, 1.44}, std::pair{1.2, 0.64}}) {
    ArmDesign design;
    design.joints.resize(2);
    design.joints[1].length_scale = length;
    design.joints[1].section_scale = section;
    const auto stretched = make_clearance(*nominal, make_gantry(), design);
    const Capsule before = *nominal->capsules()[2], after = *stretched->capsules()[2];
    EXPECT_EQ(after.to_m, Vector3d(length * 0.3, 0, 0));
    for (int i = 0; i < 500; ++i) {
      const Vector3d way(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const Vector3d point = before.from_m + random.uniform(0, 1) * (before.to_m - before.from_m) +
                             before.radius_m * way.normalized();
      const Vector3d moved(length * point.x(), std::sqrt(section) * point.y(),
                           std::sqrt(section) * point.z());
      EXPECT_LE(calc_segment_distance_m(after, {moved, moved, 0}), after.radius_m + 1e-12);
    }
  }
}

}  // namespace
}  // namespace armwright
