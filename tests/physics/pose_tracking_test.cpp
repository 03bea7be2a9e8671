// Tasks with a tool orientation, on arms without a closed form. All engines agree, and the six-axis
// arm agrees with the four-axis arm that the thesis made of it.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "sim/tracking/path_check.hpp"
#include "tracking_arms.hpp"

namespace armwright {
namespace {

using namespace physics_test;

RobotModel load_six() {
  return load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_six.urdf");
}

// The tool points down, as in the thesis. Turns about its axis are free, or none is.
TrackingTask make_six_task(ToolOrientation orientation) {
  TrackingTask task = make_e6_task();
  task.kinematics = KinematicsChoice::numeric;
  task.tool.orientation = orientation;
  task.tool.axis = Eigen::Vector3d::UnitX();
  task.tool.turn = make_turn({0, std::numbers::pi / 2, 0});
  task.home = {0, 0.2, 0.2, 0, 1.2, 0};
  task.limits = LimitPolicy::warn;
  return task;
}

// The design of table A.10, with drives for axes 4 and 6 that are as stiff, relative to their
// inertia, as the drive of axis 5.
ArmDesign make_six_design() {
  ArmDesign design = kTableA10;
  design.joints.insert(design.joints.begin() + 3, {{4000, 10000, 80}, {-3000, 3000}});
  design.joints.push_back({{2, 5, 0.06}, {-300, 300}});
  return design;
}

TestCase make_number(std::uint64_t number) {
  return make_test_case("test/2", number, WorkspaceSphere{});
}

// If only the direction is given, axes 4 and 6 need not move, and the others follow the closed
// form.
TEST(SixAxes, AnglesAreThoseOfTheReducedArm) {
  TrackingTask four_task = make_e6_task();
  const TrackingSetup four(load_irb4600(), four_task);
  const TrackingSetup six(load_six(), make_six_task(ToolOrientation::pointing));
  const TargetTable expected = four.make_targets(make_number(0));
  const TargetTable found = six.make_targets(make_number(0));
  ASSERT_EQ(found.unreachable, "");
  ASSERT_EQ(found.steps, expected.steps);
  double worst = 0;
  for (int step = 0; step < found.steps; ++step) {
    const auto q = found.positions(step);
    const auto p = expected.positions(step);
    worst = std::max({worst, std::abs(q[3]), std::abs(q[5]), std::abs(q[0] - p[0]),
                      std::abs(q[1] - p[1]), std::abs(q[2] - p[2]), std::abs(q[4] - p[3])});
  }
  EXPECT_LT(worst, 1e-8);
}

// The two arms differ only because the additional bodies can turn. With axes 4 and 6 held by
// drives, the reduced and the full arm follow alike.
TEST(SixAxes, FollowAsTheReducedArmDoes) {
  TrackingTask four_task = make_e6_task();
  const TrackingSetup four(load_irb4600(), four_task);
  const TrackingSetup six(load_six(), make_six_task(ToolOrientation::pointing));
  const auto engine = make_engine("articulated");
  const ArmDesign design = make_six_design();
  // The error of both is that of the tip alone.
  TrackingTask tip_task = make_six_task(ToolOrientation::pointing);
  for (std::uint64_t number = 0; number < 4; ++number) {
    const TargetTable four_targets = four.make_targets(make_number(number));
    const TargetTable six_targets = six.make_targets(make_number(number));
    const auto reduced = engine->simulate(four, std::vector{make_job(kTableA10, four_targets)});
    TrackingJob job = make_job(design, six_targets);
    job.recording.error_series = true;
    const auto full = engine->simulate(six, std::vector{job});
    ASSERT_EQ(full[0].status, SimulationStatus::ok) << full[0].reason;
    double sum = 0;
    for (std::size_t k = 1; k < six_targets.segments.size(); ++k) {
      const Segment& segment = six_targets.segments[k];
      double worst = 0;
      for (int step = segment.window_start; step < segment.steps; ++step) {
        worst = std::max(
            worst, full[0].error_series_m[static_cast<std::size_t>(segment.first_step + step)]);
      }
      sum += worst;
    }
    const double mean_m = sum / static_cast<double>(six_targets.segments.size() - 1);
    EXPECT_NEAR(mean_m / reduced[0].mean_error_m, 1, 0.03) << "case " << number;
  }
}

// Compares the error of a pose in ODE, which simulates bodies, with that in the lanes, which
// simulate joint positions.
TEST(PoseTracking, EnginesAgreeOnTheErrorOfAPose) {
  const TrackingSetup setup(load_six(), make_six_task(ToolOrientation::pose));
  TestCase its = make_number(1);
  its.points_m.resize(4);
  const TargetTable targets = setup.make_targets(its);
  ASSERT_EQ(targets.unreachable, "");
  ASSERT_EQ(targets.tool_points_m.size(), 12U);
  const ArmDesign design = make_six_design();
  const auto simulate = [&](const std::string& engine) {
    return make_engine(engine)->simulate(setup, std::vector{make_job(design, targets)}).front();
  };
  const TrackingResult reference = simulate("ode");
  ASSERT_EQ(reference.status, SimulationStatus::ok);
  for (const std::string& name : engine_names()) {
    const TrackingResult result = simulate(name);
    ASSERT_EQ(result.status, SimulationStatus::ok) << name;
    for (std::size_t k = 0; k < reference.point_error_m.size(); ++k) {
      EXPECT_NEAR(result.point_error_m[k] / reference.point_error_m[k], 1, 0.05)
          << name << ", point " << k + 1;
    }
  }
}

// Compares the exact derivatives of a pose's error with its differences.
TEST(PoseTracking, TheErrorOfAPoseHasDerivatives) {
  const TrackingSetup setup(load_six(), make_six_task(ToolOrientation::pose));
  TestCase its = make_number(3);
  its.points_m.resize(3);
  const TargetTable targets = setup.make_targets(its);
  const auto engine = make_engine("articulated");
  const ArmDesign design = make_six_design();
  ArmDesign direction = design;
  for (JointDrive& joint : direction.joints) {
    joint = {{0, 0, 0}, {0, 0}};
  }
  for (const std::size_t joint : {std::size_t{3}, std::size_t{5}}) {
    ArmDesign one = direction;
    one.joints[joint].gains[0] = 1;  // p
    const auto slopes =
        engine->calc_derivatives(setup, make_job(design, targets), std::vector{one});
    // Errors of 1e-5 m have the rounding of positions 1 m away: 1e-16 m.
    const double step = 1e-3 * design.joints[joint].gains[0];
    const auto calc_errors = [&](double by) {
      ArmDesign changed = design;
      changed.joints[joint].gains[0] += by;
      return engine->simulate(setup, std::vector{make_job(changed, targets)}).front().point_error_m;
    };
    const std::vector<double> above = calc_errors(step), below = calc_errors(-step);
    ASSERT_EQ(slopes.size(), 2U);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const double difference = (above[k] - below[k]) / (2 * step);
      EXPECT_NEAR(slopes[k], difference, 1e-3 * std::abs(difference)) << "joint " << joint;
      EXPECT_NE(slopes[k], 0);
    }
  }
}

// The tip's position does not depend on this drive. Without its gains the tool turns, and only the
// error of the pose shows it.
TEST(PoseTracking, TheErrorSeesJointsThatOnlyTurnTheTool) {
  ArmDesign loose = make_six_design();
  loose.joints[5] = {{0.001, 0, 0.001}, {-300, 300}};
  const auto engine = make_engine("articulated");
  const auto calc_error = [&](ToolOrientation orientation, const ArmDesign& design) {
    const TrackingSetup setup(load_six(), make_six_task(orientation));
    // The target turns the tool about its own axis; a flange without a drive does not follow.
    TestCase its = make_number(2);
    its.points_m.resize(4);
    for (const double roll_rad : {0.0, 0.5, 1.0, 0.3}) {
      its.turns.emplace_back(make_turn({0, std::numbers::pi / 2, roll_rad}));
    }
    const TargetTable targets = setup.make_targets(its);
    return engine->simulate(setup, std::vector{make_job(design, targets)}).front().mean_error_m;
  };
  const ArmDesign design = make_six_design();
  EXPECT_NEAR(
      calc_error(ToolOrientation::pointing, loose) / calc_error(ToolOrientation::pointing, design),
      1, 0.1);
  EXPECT_GT(calc_error(ToolOrientation::pose, loose),
            20 * calc_error(ToolOrientation::pose, design));
}

// The path also turns the tool, from point to point along the shortest way.
TEST(PoseTracking, TurnsAlongTheShortestWayWithThePath) {
  const TrackingSetup setup(load_six(), make_six_task(ToolOrientation::pose));
  const Eigen::Quaterniond down(make_turn({0, std::numbers::pi / 2, 0}));
  const Eigen::Quaterniond aside(make_turn({0.4, std::numbers::pi / 2, 0}));
  TestCase its;
  its.points_m = {{1.4, 0, 0.9}, {1.4, 0.5, 0.9}};
  its.turns = {down, aside};
  const TargetTable targets = setup.make_targets(its);
  ASSERT_EQ(targets.unreachable, "");
  const auto kinematics = setup.get_kinematics();
  const Segment& segment = targets.segments.front();
  double before = 0;
  for (int step = 0; step < segment.steps; ++step) {
    const ToolPose pose = kinematics->calc_pose(targets.positions(step));
    const double share = (pose.position_m.y() - 0) / 0.5;
    const double turned = down.angularDistance(Eigen::Quaterniond(pose.turn));
    EXPECT_NEAR(turned, share * 0.4, 1e-7) << "step " << step;
    EXPECT_GE(turned, before - 1e-9);
    before = turned;
  }
  EXPECT_NEAR(before, 0.4, 1e-8);
}

// The thesis's task ignores the limits of ABB's arm: most of its cases need more speed.
TEST(PathCheck, TheThesisAsksForMoreThanTheArmsSpeeds) {
  TrackingTask task = make_e6_task();
  task.distance_limit_m = 0.9;  // of Q1
  const TrackingSetup setup(load_irb4600(), task);
  int too_fast = 0;
  for (std::uint64_t number = 0; number < 20; ++number) {
    for (const PathFault& fault :
         find_path_faults(setup, setup.make_targets(make_number(number)))) {
      if (fault.kind == PathFault::Kind::speed) {
        ++too_fast;
        EXPECT_GT(fault.value, fault.limit);
        break;
      }
    }
  }
  EXPECT_GT(too_fast, 10);
}

// Tests each kind of fault on an arm that has it. The message names the point and the joint.
TEST(PathCheck, NamesPointAndJoint) {
  RobotModel robot = load_irb4600();
  TrackingTask task = make_e6_task();
  TestCase its;
  its.points_m = {{1.4, 0, 0.9}, {1.4, 0.1, 0.9}, {1.4, -0.6, 0.9}};
  const auto find = [&] {
    const TrackingSetup setup(robot, task);
    std::vector<std::string> found;
    for (const PathFault& fault : find_path_faults(setup, setup.make_targets(its))) {
      found.push_back(describe(fault, robot));
    }
    return found;
  };
  EXPECT_THAT(find(), testing::IsEmpty());
  robot.joints[0].lower = -0.2;
  EXPECT_THAT(find(), testing::ElementsAre(testing::AllOf(
                          testing::HasSubstr("on the way to point 2: joint 1 ('joint_1') would "
                                             "have to go to -0.40"),
                          testing::HasSubstr("its range is -0.2 to 3.142 rad"))));
  robot.joints[0].lower = -3;
  robot.joints[0].speed_limit = 0.5;
  EXPECT_THAT(find(), testing::ElementsAre(testing::AllOf(
                          testing::HasSubstr("on the way to point 2: joint 1 ('joint_1') would "
                                             "have to move at"),
                          testing::HasSubstr("its limit is 0.5 rad/s"))));
  robot.joints[0].speed_limit = 10;
  // A point at the end of the arm's reach, where the arm is nearly stretched out.
  its.points_m.back() = {2.4897, 0, 0.9};
  EXPECT_THAT(find(), testing::Contains(testing::HasSubstr("comes close to a singularity")));
  // With `enforce`, the same fault makes the case unreachable.
  task.limits = LimitPolicy::enforce;
  robot.joints[0].speed_limit = 0.01;
  its.points_m.back() = {1.4, -0.6, 0.9};
  const TrackingSetup setup(robot, task);
  EXPECT_THAT(setup.make_targets(its).unreachable, testing::HasSubstr("joint 1 ('joint_1')"));
}

// The arm follows the samples of a continuous path one by one, each with its own error, with the
// closed form and numerically.
TEST(ContinuousPath, EverySampleCounts) {
  TestCase its;
  its.continuous = true;
  for (int i = 0; i <= 200; ++i) {
    const double angle = std::numbers::pi * (1 - std::cos(std::numbers::pi * i / 200));
    its.points_m.emplace_back(1.4 + 0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.9);
  }
  TrackingTask task = make_e6_task();
  const auto engine = make_engine("articulated");
  std::vector<double> errors;
  for (const KinematicsChoice choice : {KinematicsChoice::palletiser, KinematicsChoice::numeric}) {
    task.kinematics = choice;
    task.home = {0, 0.2, 0.2, 1.2};
    const TrackingSetup setup(load_irb4600(), task);
    const TargetTable targets = setup.make_targets(its);
    ASSERT_EQ(targets.unreachable, "");
    ASSERT_EQ(targets.steps, 200);
    const auto result = engine->simulate(setup, std::vector{make_job(kTableA10, targets)}).front();
    ASSERT_EQ(result.point_error_m.size(), 200U);
    errors.push_back(result.mean_error_m);
    const auto ode =
        make_engine("ode")->simulate(setup, std::vector{make_job(kTableA10, targets)}).front();
    EXPECT_NEAR(ode.mean_error_m / result.mean_error_m, 1, 0.02);
    for (std::size_t k = 0; k < targets.segments.size(); ++k) {
      EXPECT_LT((calc_tip_position(setup.robot(), targets.positions(static_cast<int>(k))) -
                 its.points_m[k + 1])
                    .norm(),
                1e-8);
    }
  }
  EXPECT_GT(errors.front(), 0);
}

}  // namespace
}  // namespace armwright
