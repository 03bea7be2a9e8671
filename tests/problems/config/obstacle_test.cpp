// Obstacles of tracking problems, and those that are the collision shapes of a URDF.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "problems/config/path_survey.hpp"
#include "problems/load_tracking.hpp"
#include "problems/motion/motion_problem.hpp"
#include "problems/problem_folder.hpp"
#include "sim/generated_arm.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/robot/mesh_file.hpp"
#include "sim/tracking/path_check.hpp"

namespace armwright {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// The tip passes the middle of this line, where the post's upper end stands in its way.
const std::vector<std::string> kLine = {"task.limits=warn", "path.kind=line",
                                        "path.from_m=[1.4,-0.5,0.9]", "path.to_m=[1.4,0.5,0.9]",
                                        "task.speed_m_per_s=0.5"};
constexpr const char* kPost =
    "obstacle=[{name=\"post\",kind=\"cylinder\",centre_m=[1.4,0,0.5],radius_m=0.05,height_m=0.9}]";
constexpr const char* kFar =
    "obstacle=[{name=\"far\",kind=\"box\",centre_m=[9,9,9],edges_m=[1,1,1]}]";

std::vector<std::string> with(std::vector<std::string> settings,
                              const std::vector<std::string>& others) {
  settings.insert(settings.end(), others.begin(), others.end());
  return settings;
}

TEST(TaskObstacle, OnThePathIsNamedBeforeAnythingRuns) {
  EXPECT_THAT(check_paths(load_problem("q2-e6", kLine)), Not(Contains(HasSubstr("post"))));
  EXPECT_THAT(check_paths(load_problem("q2-e6", with(kLine, {kPost}))),
              Contains(AllOf(HasSubstr("on the way to point 1: link 3 ('link_2') would be "),
                             HasSubstr(" m inside the obstacle 'post' (at "))));
  const LoadedProblem strict = load_problem("q2-e6", with(kLine, {kPost, "task.limits=enforce"}));
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { check_paths(strict); }),
              HasSubstr("inside the obstacle 'post'"));
}

TEST(TaskObstacle, OutOfReachChangesNoFaultAndNoBitOfAnEvaluation) {
  const std::vector<std::string> fast = {"task.limits=warn"};  // joints are too slow for Q1
  const LoadedProblem none = load_problem("q1-complex", fast),
                      far = load_problem("q1-complex", with(fast, {kFar}));
  const std::vector<std::string> faults = check_paths(none);
  EXPECT_GT(faults.size(), 1u);
  EXPECT_EQ(check_paths(far), faults);
  const auto track = [](const LoadedProblem& problem) {
    const TrackingProblem& its = *problem.tracking();
    return its.track(its.config().start, its.get_set("test/1"), 0).point_error_m;
  };
  EXPECT_EQ(track(none), track(far));
}

// What a file without the keys records is what version 1.0 recorded.
TEST(TaskObstacle, AbsentKeysAreNotRecorded) {
  const std::string recorded = load_problem("q1-complex").resolved_json;
  for (const char* key : {"obstacle", "clearance", "position_m"}) {
    EXPECT_THAT(recorded, Not(HasSubstr(key)));
  }
}

TEST(TaskObstacle, KeepsAProposedWorkspaceClear) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_arm_urdf(0));
  const std::vector<std::string> arm = {"robot.urdf=\"" + folder.path("arm.urdf") + "\""};
  const TrackingConfig free = load_problem("robot", arm).tracking()->config();
  // A ball where the workspace would be.
  const Vector3d& at_m = free.workspace.centre_m;
  const LoadedProblem problem = load_problem(
      "robot",
      with(arm, {fmt::format("obstacle=[{{name=\"ball\",kind=\"sphere\",centre_m=[{},{},{}]"
                             ",radius_m={}}}]",
                             at_m.x(), at_m.y(), at_m.z(), free.workspace.radius_m),
                 "task.clearance_m=0.01"}));
  const TrackingConfig& config = problem.tracking()->config();
  EXPECT_NE(config.workspace.centre_m, at_m);
  const TrackingSetup& setup = problem.tracking()->setup();
  for (std::uint64_t number = 0; number < 5; ++number) {
    const TargetTable table =
        setup.make_targets(problem.tracking()->get_set("test/unseen").make_case(number));
    ASSERT_EQ(table.unreachable, "");
    for (int step = 0; step < table.steps; step += 3) {
      const auto nearest =
          config.task.clearance->find_nearest(calc_link_poses(config.robot, table.positions(step)));
      EXPECT_GE(nearest.distance_m, 0.01);
    }
  }
  // The record makes the same problem without a search.
  EXPECT_EQ(load_recorded_problem(problem.resolved_json, problem.name, "").resolved_json,
            problem.resolved_json);
}

TEST(TaskObstacle, FollowsTheLinksOfADesign) {
  const auto problem = load_tracking("co-design", {kFar, "task.limits=warn"});
  ArmDesign design = problem->config().start;
  EXPECT_EQ(problem->make_task(design).clearance, problem->config().task.clearance);
  design.joints[1].length_scale = 1.2;
  EXPECT_NEAR(problem->make_task(design).clearance->capsules()[2]->radius_m,
              1.2 * problem->config().task.clearance->capsules()[2]->radius_m, 1e-15);
}

constexpr const char* kScene = R"(<robot name="cell">
<link name="world"><visual><geometry><sphere radius="5"/></geometry></visual></link>
<joint name="a" type="fixed"><parent link="world"/><child link="table"/>
<origin xyz="1 0 0.5" rpy="0 0 1.5707963267948966"/></joint>
<link name="table">
<collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.6 0.1"/></geometry></collision>
<collision><origin xyz="0 0 0.3" rpy="1.5707963267948966 0 0"/>
<geometry><cylinder radius="0.05" length="0.8"/></geometry></collision>
</link>
<joint name="b" type="prismatic"><parent link="table"/><child link="ball"/>
<origin xyz="0 0.1 0"/><axis xyz="0 0 1"/><limit lower="0.2" upper="1" effort="1" velocity="1"/></joint>
<link name="ball"><collision><geometry><sphere radius="0.07"/></geometry></collision></link>
</robot>)";

// A problem that a scene stands in, turned by a right angle about z and lifted by 2 m.
constexpr const char* kSceneProblem = R"(extends = "base"
[task]
limits = "warn"
[[obstacle]]
kind = "urdf"
file = "cell.urdf"
position_m = [0, 0, 2]
rpy_rad = [0, 0, 1.5707963267948966]
)";

TEST(UrdfObstacles, StandWhereTheFileSays) {
  const ProblemFolder folder;
  folder.write("cell.urdf", kScene);
  folder.write("p.toml", kSceneProblem);
  const LoadedProblem loaded = folder.load("p.toml");
  const std::vector<Obstacle>& all = loaded.tracking()->config().task.clearance->obstacles();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_TRUE(loaded.input_hashes.contains("cell.urdf"));
  // In the scene the table stands at (1, 0, 0.5), its x axis along y: the box at (1, 0.2, 0.5).
  // Turned about z, (x, y) becomes (-y, x).
  EXPECT_EQ(all[0].name, "cell/table");
  EXPECT_EQ(all[0].kind, ObstacleKind::box);
  EXPECT_LT((all[0].centre_m() - Vector3d(-0.2, 1, 2.5)).norm(), 1e-12);
  EXPECT_LT((all[0].pose.linear() * Vector3d::UnitX() + Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_EQ(all[0].half_m, Vector3d(0.2, 0.3, 0.05));
  // The cylinder lies along -y of the table, which is x of the scene and y of the world.
  EXPECT_EQ(all[1].name, "cell/table (2)");
  EXPECT_EQ(all[1].kind, ObstacleKind::cylinder);
  EXPECT_LT((all[1].centre_m() - Vector3d(0, 1, 2.8)).norm(), 1e-12);
  EXPECT_LT((all[1].pose.linear() * Vector3d::UnitZ()).cross(Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_EQ(all[1].half_m, Vector3d(0.05, 0.05, 0.4));
  // A capsule beside its end, on its axis, and one beside its middle.
  EXPECT_NEAR(calc_distance_m(Capsule{{0, 1.6, 2.8}, {0, 1.9, 2.8}, 0.01}, all[1]), 0.19, 1e-9);
  EXPECT_NEAR(calc_distance_m(Capsule{{0.3, 1, 2.8}, {0.3, 1.1, 2.8}, 0.01}, all[1]), 0.24, 1e-9);
  // The slide stands at 0, outside of its range.
  EXPECT_EQ(all[2].name, "cell/ball");
  EXPECT_EQ(all[2].kind, ObstacleKind::sphere);
  EXPECT_LT((all[2].centre_m() - Vector3d(0, 0.9, 2.5)).norm(), 1e-12);
  EXPECT_EQ(all[2].capsule.radius_m, 0.07);
}

TEST(UrdfObstacles, StandInMotionsTooUnderANameOfTheirOwn) {
  const ProblemFolder folder;
  folder.write("cell.urdf", kScene);
  const LoadedProblem loaded =
      load_problem("saravanan-puma",
                   std::vector{fmt::format("obstacle=[{{kind=\"urdf\",name=\"fence\",file=\"{}\","
                                           "position_m=[5,5,5]}}]",
                                           folder.path("cell.urdf"))});
  const MotionProblem* motion = find_motion(*loaded.problem);
  ASSERT_NE(motion, nullptr);
  EXPECT_EQ(motion->config().clearance->obstacles().back().name, "fence/ball");
}

TEST(UrdfObstacles, OfAMeshAreTheCapsuleAroundIt) {
  const ProblemFolder folder;
  if (!can_read_meshes()) {
    GTEST_SKIP() << "this build has no Assimp";
  }
  // A rod of 1 x 0.02 x 0.02 m along x, in mm.
  folder.write(
      "rod.obj",
      "v 0 -10 -10\nv 1000 -10 -10\nv 0 10 -10\nv 1000 10 10\nv 0 0 10\nf 1 2 3\nf 2 4 5\n");
  folder.write("cell.urdf", R"(<robot name="cell"><link name="rod"><collision>
<origin xyz="0 2 0"/><geometry><mesh filename="rod.obj" scale="0.001 0.001 0.001"/></geometry>
</collision></link></robot>)");
  folder.write("p.toml",
               std::string("extends = \"base\"\n[task]\nlimits = \"warn\"\n[[obstacle]]\n") +
                   "kind = \"urdf\"\nfile = \"cell.urdf\"\n");
  const LoadedProblem loaded = folder.load("p.toml");
  const Obstacle& rod = loaded.tracking()->config().task.clearance->obstacles().front();
  EXPECT_EQ(rod.kind, ObstacleKind::capsule);
  EXPECT_TRUE(loaded.input_hashes.contains("rod.obj"));
  for (const Vector3d& corner : {Vector3d(0, 1.99, -0.01), Vector3d(1, 2.01, 0.01)}) {
    EXPECT_LE(calc_distance_m(rod.capsule, Capsule{corner, corner, 0}),
              1e-6);  // floats of the file
  }
  EXPECT_LT(rod.capsule.radius_m, 0.02);
}

struct BadObstacle {
  const char* name;
  std::string text;   // after the base problem
  std::string scene;  // cell.urdf
  std::string message;
  ErrorKind kind = ErrorKind::usage;
};
class BadObstacleTest : public testing::TestWithParam<BadObstacle> {};

TEST_P(BadObstacleTest, IsRefusedBeforeAnythingRuns) {
  const ProblemFolder folder;
  folder.write("cell.urdf", GetParam().scene);
  folder.write("p.toml", "extends = \"base\"\n" + GetParam().text);
  EXPECT_THAT(folder.shorten(error_of(GetParam().kind, [&] { folder.load("p.toml"); })),
              HasSubstr(GetParam().message));
}

const std::string kWarn = "[task]\nlimits = \"warn\"\n";
const std::string kSphere = "[[obstacle]]\nname = \"ball\"\nkind = \"sphere\"\nradius_m = 0.3\n";
const std::string kUrdf = kWarn + "[[obstacle]]\nkind = \"urdf\"\nfile = \"cell.urdf\"\n";

std::string make_scene(const std::string& collision) {
  return "<robot name=\"cell\"><link name=\"table\">" + collision + "</link></robot>";
}

INSTANTIATE_TEST_SUITE_P(
    All, BadObstacleTest,
    testing::Values(
        BadObstacle{"NothingToBeClearOf", kWarn + "clearance_m = 0.1\n", "",
                    "p.toml:4: task.clearance_m is 0.1; there is nothing to be clear of; add an "
                    "[[obstacle]], or set task.self_clearance = true"},
        BadObstacle{"PathsThatAreNotChecked", kSphere + "centre_m = [9, 9, 9]\n", "",
                    "task.limits is missing; paths are not checked then, and could pass through "
                    "obstacles; set it to \"warn\" or \"enforce\""},
        BadObstacle{"AroundHome",
                    kWarn + "home = [0, 0, 0, 0]\n" + kSphere + "centre_m = [0.9, 0, 1.5]\n", "",
                    "p.toml:4: task.home is [0, 0, 0, 0]; the link 'link_"},
        BadObstacle{"AFormThatIsNone", kWarn + "[[obstacle]]\nkind = \"cone\"\n", "",
                    "p.toml:5: unknown obstacle[0].kind 'cone'. Valid: sphere, capsule, box, "
                    "cylinder, urdf"},
        BadObstacle{"NoFile", kWarn + "[[obstacle]]\nkind = \"urdf\"\nfile = \"scene.urdf\"\n", "",
                    "p.toml:6: obstacle[0].file is \"scene.urdf\"; there is no such file, in "},
        BadObstacle{
            "APlaceOfAForm", kUrdf + "centre_m = [0, 0, 0]\n",
            make_scene("<collision><geometry><sphere radius=\"1\"/></geometry></collision>"),
            "unknown key obstacle[0].centre_m"},
        BadObstacle{"NoShapes", kUrdf,
                    make_scene("<visual><geometry><sphere radius=\"1\"/></geometry></visual>"),
                    "p.toml:6: obstacle[0].file is \"cell.urdf\"; none of its links has a "
                    "<collision> shape, and only these are obstacles"},
        BadObstacle{
            "AShapeWithoutSize", kUrdf,
            make_scene("<collision><geometry><sphere radius=\"0\"/></geometry></collision>"),
            "cell.urdf:1: link 'table': the <collision> has a size of 0; give it a size",
            ErrorKind::bad_data},
        BadObstacle{
            "AFormOfNoUrdf", kUrdf,
            make_scene("<collision><geometry><capsule radius=\"1\"/></geometry></collision>"),
            "(write a capsule as three <collision>, a cylinder and a sphere at each end)",
            ErrorKind::bad_data},
        BadObstacle{"AMeshThatIsNotThere", kUrdf,
                    make_scene("<collision><geometry><mesh filename=\"no.stl\"/></geometry>"
                               "</collision>"),
                    "cell.urdf:1: link 'table': the mesh 'no.stl' of its <collision> was not found",
                    ErrorKind::bad_data},
        BadObstacle{"NoXml", kUrdf, "<robot", "cell.urdf:1: ", ErrorKind::bad_data},
        BadObstacle{"TwoRoots", kUrdf,
                    "<robot name=\"cell\"><link name=\"a\"/><link name=\"b\"/></robot>",
                    "the links 'a' and 'b' both have no parent joint", ErrorKind::bad_data}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace armwright
