// What is proposed for an arm of which only the URDF is known.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/path_survey.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/problem_folder.hpp"
#include "sim/generated_arm.hpp"
#include "sim/tracking/path_check.hpp"

namespace armwright {
namespace {

LoadedProblem load_robot(const std::string& robot, std::vector<std::string> overrides = {}) {
  overrides.push_back("robot.urdf=\"" + robot + "\"");
  return load_problem("robot", overrides);
}

std::string set_key(const std::string& key, const std::string& value) {
  return key + "=" + value;
}

// Unseen cases: what was proposed was checked with others.
TEST(RobotProposal, TheJointsCanDoWhatIsProposed) {
  const ProblemFolder folder;
  for (const int number : {0, 2, 4}) {
    folder.write("arm.urdf", make_arm_urdf(number));
    const LoadedProblem problem = load_robot(folder.path("arm.urdf"));
    const TrackingConfig& config = problem.tracking()->config();
    const TrackingSetup& setup = problem.tracking()->setup();
    for (std::uint64_t i = 0; i < 5; ++i) {
      const TargetTable table =
          setup.make_targets(problem.tracking()->get_set("test/unseen").make_case(i));
      ASSERT_EQ(table.unreachable, "") << "arm " << number;
      for (const PathFault& fault : find_path_faults(setup, table)) {
        ADD_FAILURE() << describe(fault, config.robot);
      }
    }
    EXPECT_GT(config.workspace.radius_m, 0.02);
    for (std::size_t i = 0; i < config.robot.joint_count(); ++i) {
      const EffortLimits& limits = config.start.joints[i].limits;
      EXPECT_GT(limits.max, 0);
      EXPECT_LE(limits.max, config.robot.joints[i].effort_limit);
    }
  }
}

// The recorded numbers make the same problem again, to the last bit, without a search.
TEST(RobotProposal, WhatIsRecordedMakesTheSameProblem) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_arm_urdf(3));
  const LoadedProblem first = load_robot(folder.path("arm.urdf"));
  EXPECT_EQ(first.name, "arm");
  const LoadedProblem again = load_recorded_problem(first.resolved_json, first.name, "");
  EXPECT_EQ(again.resolved_json, first.resolved_json);
  const TrackingConfig& a = first.tracking()->config();
  const TrackingConfig& b = again.tracking()->config();
  EXPECT_EQ(a.workspace.centre_m, b.workspace.centre_m);
  EXPECT_EQ(a.workspace.radius_m, b.workspace.radius_m);
  EXPECT_EQ(a.task.speed_m_per_s, b.task.speed_m_per_s);
  EXPECT_EQ(a.task.home, b.task.home);
  EXPECT_EQ(a.task.tool.turn, b.task.tool.turn);
  EXPECT_EQ(first.tracking()->make_vector(a.start), again.tracking()->make_vector(b.start));
  const TestCase its = first.tracking()->get_set("test/2").make_case(0);
  EXPECT_EQ(first.tracking()->setup().make_targets(its).joint_positions,
            again.tracking()->setup().make_targets(its).joint_positions);
}

TEST(RobotProposal, WhatTheFileSaysHolds) {
  const LoadedProblem problem = load_robot(
      "irb4600_six",
      {set_key("workspace.centre_m", "[1.4, 0, 0.9]"), set_key("workspace.radius_m", "0.3"),
       set_key("workspace.shortest_move_m", "0.05"), set_key("task.tool_rpy_rad", "[0, 1.57, 0]"),
       set_key("task.home", "[0, 0.2, 0.2, 0, 1.2, 0]"), set_key("task.speed_m_per_s", "0.4")});
  const TrackingConfig& config = problem.tracking()->config();
  EXPECT_EQ(config.workspace.radius_m, 0.3);
  EXPECT_EQ(config.task.speed_m_per_s, 0.4);
  EXPECT_EQ(config.task.tool.orientation, ToolOrientation::pose);
  EXPECT_EQ(config.task.distance_limit_m, 0.6);
}

TEST(RobotProposal, PlanarArmsMoveInTheirPlane) {
  const LoadedProblem problem = load_robot("planar2");
  const WorkspaceSphere& disc = problem.tracking()->config().workspace;
  ASSERT_TRUE(disc.normal);
  EXPECT_NEAR(std::abs(disc.normal->y()), 1, 1e-9);
  for (const Eigen::Vector3d& point : problem.tracking()->get_set("test/2").make_case(3).points_m) {
    EXPECT_NEAR((point - disc.centre_m).dot(*disc.normal), 0, 1e-12);
    EXPECT_LE((point - disc.centre_m).norm(), disc.radius_m * (1 + 1e-12));
  }
}

// Returns the URDF with its effort limits multiplied.
std::string scale_efforts(std::string urdf, double factor) {
  const std::string key = "effort=\"";
  for (std::size_t at = urdf.find(key); at != std::string::npos; at = urdf.find(key, at + 1)) {
    const std::size_t begin = at + key.size();
    const std::size_t end = urdf.find('"', begin);
    urdf.replace(begin, end - begin,
                 fmt::format("{}", factor * std::stod(urdf.substr(begin, end - begin))));
  }
  return urdf;
}

// Returns the largest share of a joint's effort limit that holds the arm on unseen cases.
double find_held_share(const TrackingProblem& problem) {
  TrackingTask task = problem.config().task;
  task.feed_forward = FeedForward::gravity;
  const TrackingSetup setup(problem.config().robot, task);
  double most = 0;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const TargetTable table = setup.make_targets(problem.get_set("test/unseen").make_case(i));
    for (int step = 0; step < table.steps; ++step) {
      for (std::size_t joint = 0; joint < table.joints; ++joint) {
        most = std::max(most, std::abs(table.feed_forward(step)[joint]) /
                                  setup.robot().joints[joint].effort_limit);
      }
    }
  }
  return most;
}

TEST(RobotProposal, ToolsPointDownAboveTheFloorAndBesideTheBase) {
  const ProblemFolder folder;
  folder.write("six.urdf", make_arm_urdf(3));
  folder.write("five.urdf", make_arm_urdf(2));
  for (const std::string& robot : {folder.path("six.urdf"), folder.path("five.urdf"),
                                   std::string("irb4600_six"), std::string("arm7")}) {
    SCOPED_TRACE(robot);
    const LoadedProblem problem = load_robot(robot);
    const TrackingConfig& config = problem.tracking()->config();
    const TrackingTask& task = config.task;
    ASSERT_NE(task.tool.orientation, ToolOrientation::free);
    EXPECT_NEAR((task.tool.turn * task.tool.axis).z(), -1, 1e-6);
    ASSERT_EQ(task.floor_m, 0);
    EXPECT_GE(config.workspace.centre_m.z(), config.workspace.radius_m);
    EXPECT_GT((config.workspace.centre_m - config.robot.joints.front().origin.translation())
                  .head<2>()
                  .norm(),
              config.workspace.radius_m);
    // Independently of the check of paths: no joint that can rise is below the floor.
    const TrackingSetup& setup = problem.tracking()->setup();
    const auto kinematics = setup.get_kinematics();
    const TargetTable table =
        setup.make_targets(problem.tracking()->get_set("test/unseen").make_case(1));
    ASSERT_EQ(table.unreachable, "");
    for (int step = 0; step < table.steps; step += 10) {
      const auto places_m = kinematics->calc_places(table.positions(step));
      for (std::size_t i = 2; i < places_m.size(); ++i) {
        EXPECT_GT(places_m[i].z(), 0) << "place " << i;
      }
    }
  }
}

// The fourth joint of this arm turns about the forearm, so the tool cannot point down everywhere.
TEST(RobotProposal, AToolThatCannotKeepItsDirectionIsFree) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_arm_urdf(1));
  EXPECT_EQ(load_robot(folder.path("arm.urdf")).tracking()->config().task.tool.orientation,
            ToolOrientation::free);
  EXPECT_THAT(error_of(ErrorKind::bad_data,
                       [&] { load_robot(folder.path("arm.urdf"), {"task.orientation=pointing"}); }),
              testing::HasSubstr("no place was found where its tool can move along straight lines "
                                 "with task.orientation = \"pointing\""));
}

TEST(RobotProposal, FloorsAreBelowTheBase) {
  EXPECT_THAT(usage_error_of([] { load_robot("irb4600_six", {"task.floor_m=0.7"}); }),
              testing::AllOf(testing::HasSubstr("task.floor_m is 0.7"),
                             testing::HasSubstr("the arm's first joint is lower, at 0.495 m")));
  const LoadedProblem low = load_robot("irb4600_six", {"task.floor_m=-0.2"});
  EXPECT_EQ(low.tracking()->config().task.floor_m, -0.2);
}

TEST(RobotProposal, PathsBelowTheFloorAreFaults) {
  const std::vector<std::string> line = {
      "path.kind=line", set_key("path.from_m", "[1.4, -0.3, 0.1]"),
      set_key("path.to_m", "[1.4, 0.3, -0.1]"), "task.floor_m=0"};
  EXPECT_THAT(check_paths(load_robot("irb4600_six", line)),
              testing::Contains(testing::HasSubstr("are needed above task.floor_m")));
}

// Gravity takes almost 90 % of what the motors have: slowing down does not help to hold the arm, so
// the speed follows from the rest.
TEST(RobotProposal, ArmsWhoseMotorsGravityNeedsAreNotSlowedDownInVain) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_arm_urdf(3));
  const LoadedProblem strong = load_robot(folder.path("arm.urdf"));
  folder.write("weak.urdf",
               scale_efforts(make_arm_urdf(3), find_held_share(*strong.tracking()) / 0.85));
  const LoadedProblem weak = load_robot(folder.path("weak.urdf"));
  EXPECT_GT(find_held_share(*weak.tracking()), 0.6);
  EXPECT_LE(find_held_share(*weak.tracking()), 0.95);
  const auto duration_s = [](const LoadedProblem& problem) {
    const TrackingConfig& config = problem.tracking()->config();
    return calc_case_duration_s(config, config.task);
  };
  EXPECT_LT(duration_s(weak), 4 * duration_s(strong));
}

// Almost all of the mass is at the tip: when one of the two joints is driven, the other one turns.
TEST(RobotProposal, ControlPeriodsAreShortWhereJointsMoveEachOther) {
  const ProblemFolder folder;
  folder.write("arm.urdf",
               scale_efforts(read_file(resolve_config("robots", "planar2"), 1 << 20), 100));
  const std::vector<std::string> loaded = {"task.load_kg=40", "task.load_com_m=[0,0,0]"};
  const LoadedProblem coupled = load_robot(folder.path("arm.urdf"), loaded);
  const TrackingTask& task = coupled.tracking()->config().task;
  EXPECT_LT(task.control_period_s, 0.01);
  EXPECT_NEAR(task.control_period_s / task.physics.substeps, 0.001, 1e-12);
  EXPECT_EQ(load_robot(folder.path("arm.urdf")).tracking()->config().task.control_period_s, 0.01);
  // The steps belong to the period: a user who gives the period gives them, too.
  std::vector<std::string> given = loaded;
  given.emplace_back("control.period_s=0.01");
  EXPECT_EQ(load_robot(folder.path("arm.urdf"), given).tracking()->config().task.physics.substeps,
            1);
}

double get_start_bandwidth(const LoadedProblem& problem) {
  return nlohmann::json::parse(problem.resolved_json)
      .at("variables")
      .at("start_bandwidth_rad_per_s")
      .get<double>();
}

// The weight of an arm with soft joints pulls it down; stiffer controllers than usual hold it better.
TEST(RobotProposal, StartsThatFailGetOtherControllers) {
  EXPECT_EQ(get_start_bandwidth(load_robot("planar2")), 10);
  const std::vector<std::string> soft = {"robot.elastic_hz=5", "robot.armature_share=0.3"};
  const LoadedProblem changed = load_robot("planar2", soft);
  EXPECT_GT(get_start_bandwidth(changed), 10);
  const auto calc_error_m = [](const LoadedProblem& problem) {
    const TrackingProblem& its = *problem.tracking();
    const TargetTable table = its.setup().make_targets(its.get_set("test/unseen").make_case(0));
    TrackingJob job;
    job.design = &its.config().start;
    job.targets = &table;
    const TrackingResult result =
        its.config().engines.judging->simulate(its.setup(), {&job, 1}).front();
    return result.status == SimulationStatus::ok ? result.mean_error_m : 1e9;
  };
  std::vector<std::string> kept = soft;
  kept.emplace_back("variables.start_bandwidth_rad_per_s=10");
  EXPECT_LT(calc_error_m(changed), 0.1);
  EXPECT_GT(calc_error_m(load_robot("planar2", kept)), calc_error_m(changed));
}

// Version 1.0 recorded neither a bandwidth nor a floor.
TEST(RobotProposal, RecordsOfVersion1KeepTheirStart) {
  const LoadedProblem first =
      load_robot("arm7", {"control.period_s=0.004", "variables.start_bandwidth_rad_per_s=0"});
  EXPECT_THAT(first.resolved_json, testing::Not(testing::HasSubstr("start_bandwidth")));
  const LoadedProblem again = load_recorded_problem(first.resolved_json, first.name, "");
  EXPECT_EQ(again.resolved_json, first.resolved_json);
  EXPECT_EQ(first.tracking()->make_vector(first.tracking()->config().start),
            again.tracking()->make_vector(again.tracking()->config().start));
  // Its bound on D is that of a period of 10 ms, which is below the bound of 4 ms.
  const LoadedProblem now =
      load_robot("arm7", {"control.period_s=0.004", "variables.start_bandwidth_rad_per_s=10"});
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_LE(again.tracking()->config().start.joints[i].gains[2],
              now.tracking()->config().start.joints[i].gains[2]);
  }
}

// A path of the user's own: the speed and the controllers are proposed for it.
TEST(RobotProposal, PathsOfTheUsersOwn) {
  const LoadedProblem problem =
      load_robot("irb4600_six", {"path.kind=line", set_key("path.from_m", "[1.4, -0.3, 1]"),
                                 set_key("path.to_m", "[1.4, 0.3, 1]")});
  const TrackingConfig& config = problem.tracking()->config();
  EXPECT_EQ(config.task.tool.orientation, ToolOrientation::free);
  EXPECT_NEAR(config.task.distance_limit_m, 0.6, 1e-12);
  EXPECT_GT(config.task.speed_m_per_s, 0.05);
  EXPECT_THAT(check_paths(problem), testing::IsEmpty());
}

// A file of the user's own, in whatever folder, goes on from a shipped one.
TEST(RobotProposal, FilesExtendShippedProblems) {
  const ProblemFolder folder;
  folder.write("mine.toml",
               "extends = \"robot\"\n[robot]\nurdf = \"planar2\"\n"
               "[task]\nload_kg = 0.5\n");
  const LoadedProblem problem = folder.load("mine.toml");
  EXPECT_EQ(problem.name, "mine");
  EXPECT_EQ(load_recorded_problem(problem.resolved_json, problem.name, "").name, "mine");
  EXPECT_EQ(problem.tracking()->config().task.load_kg, 0.5);
  EXPECT_EQ(problem.tracking()->config().task.physics.substeps, 10);
  EXPECT_THAT(folder.refusal_of("extends = \"robt\"\n"),
              testing::HasSubstr("unknown file to extend 'robt'; did you mean 'robot'?"));
  EXPECT_THAT(
      folder.refusal_of("extends = \"robot\"\nname = \"a/b\"\n"),
      testing::HasSubstr("name is \"a/b\"; folders are named after it, so it must not be empty"));
}

struct Refusal {
  std::vector<std::string> overrides;
  std::string message;
};

TEST(RobotProposal, RefusesHalvesOfWhatBelongsTogether) {
  const std::vector<Refusal> refusals = {
      {{"workspace.radius_m=0.3"}, "workspace.centre_m belongs to it; give both or neither"},
      {{"workspace.centre_m=[1.4, 0, 0.9]", "task.tool_rpy_rad=[0,1,0]"},
       "workspace.radius_m belongs to it; give both or neither"},
      {{"task.home=[0,0,0,0,0,0]"}, "it belongs to a workspace of your own"},
      {{"workspace.centre_m=[1.4, 0, 0.9]", "workspace.radius_m=0.3", "task.orientation=pose"},
       "it needs task.tool_rpy_rad, how the tool is to be turned there"}};
  for (const Refusal& refusal : refusals) {
    EXPECT_THAT(usage_error_of([&] { load_robot("irb4600_six", refusal.overrides); }),
                testing::HasSubstr(refusal.message));
  }
}

// Motors that cannot hold their own arm, and tips that move on a sphere.
TEST(RobotProposal, SaysWhyNothingCanBeProposed) {
  const ProblemFolder folder;
  folder.write("weak.urdf", scale_efforts(make_arm_urdf(0), 1e-4));
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { load_robot(folder.path("weak.urdf")); }),
              testing::AllOf(testing::HasSubstr("weak.urdf"),
                             testing::HasSubstr("N m to hold the arm in the easiest of 2000 "
                                                "postures above the floor, its effort limit is")));
  folder.write("pan_tilt.urdf", R"(<robot name="pan_tilt"><link name="base"/>
<joint name="pan" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="10"/></joint>
<link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="tilt" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="1" effort="10"/></joint>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="0.5 0 0"/></joint>
<link name="tip"/></robot>)");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { load_robot(folder.path("pan_tilt.urdf")); }),
              testing::HasSubstr("its tip moves on a curved surface, on which there are no "
                                 "straight moves"));
}

}  // namespace
}  // namespace armwright
