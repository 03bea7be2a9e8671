// What is proposed for an arm of which only the URDF is known.
#include <gmock/gmock.h>

#include <cmath>

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
  std::string weak = make_arm_urdf(0);
  for (std::size_t at = weak.find("effort=\""); at != std::string::npos;
       at = weak.find("effort=\"", at + 1)) {
    weak.replace(at, weak.find('"', at + 8) - at + 1, "effort=\"0.01\"");
  }
  folder.write("weak.urdf", weak);
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { load_robot(folder.path("weak.urdf")); }),
              testing::AllOf(testing::HasSubstr("weak.urdf"),
                             testing::HasSubstr("N m to hold the arm in its workspace, its effort "
                                                "limit is 0.01")));
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
