// Paths of the user's own: what they become, and what is said of files that are none.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "problems/config/path_survey.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

TestCase load_path(const std::string& toml, const ProblemFolder& folder = {}) {
  folder.write("p.toml", "extends = \"base\"\n" + toml);
  return *folder.load("p.toml").tracking()->config().path;
}

TEST(Path, PointsAreMovedBetween) {
  const ProblemFolder folder;
  folder.write("p.toml", R"(extends = "base"
[[path.point]]
position_m = [1.4, 0, 0.9]
[[path.point]]
position_m = [1.4, 0.3, 0.9]
[path]
kind = "points"
)");
  const LoadedProblem problem = folder.load("p.toml");
  const TestCase path = *problem.tracking()->config().path;
  EXPECT_FALSE(path.continuous);
  EXPECT_EQ(path.points_m, (std::vector<Eigen::Vector3d>{{1.4, 0, 0.9}, {1.4, 0.3, 0.9}}));
  EXPECT_TRUE(problem.tracking()->config().task.count_first_point) << "every move was asked for";
  EXPECT_EQ(problem.sets.test_cases, 1) << "all would be the same";
  EXPECT_EQ(to_text(problem.schedule), "fixed:1");
  // Whatever the set and the number.
  for (const char* set : {"train/1", "validation/1", "test/2"}) {
    EXPECT_EQ(problem.tracking()->get_set(set).make_case(77).points_m, path.points_m);
    EXPECT_FALSE(problem.tracking()->get_set(set).size());
  }
}

TEST(Path, ALineGoesThereAndBackAgain) {
  const TestCase path =
      load_path("[path]\nkind = 'line'\nfrom_m = [1, 0, 1]\nto_m = [1.5, 0, 1]\nrepeats = 2\n");
  const Eigen::Vector3d from(1, 0, 1), to(1.5, 0, 1);
  EXPECT_EQ(path.points_m, (std::vector<Eigen::Vector3d>{from, to, from, to, from}));
}

TEST(Path, ACircleIsGoneThroughWithoutAStop) {
  const TestCase path = load_path(
      "[path]\nkind = 'circle'\ncentre_m = [1.4, 0.1, 0.9]\nnormal = [0, 0, 2]\nradius_m = 0.2\n"
      "start = [0, 1, 0.3]\n[task]\nspeed_m_per_s = 0.5\nsignal = 'triangular'\n");
  EXPECT_TRUE(path.continuous);
  const Eigen::Vector3d centre(1.4, 0.1, 0.9);
  for (const Eigen::Vector3d& point : path.points_m) {
    EXPECT_NEAR((point - centre).norm(), 0.2, 1e-12);
    EXPECT_EQ(point.z(), 0.9);
  }
  EXPECT_LT((path.points_m.front() - Eigen::Vector3d(1.4, 0.3, 0.9)).norm(), 1e-12);
  EXPECT_LT((path.points_m.back() - path.points_m.front()).norm(), 1e-9);
  // 2 pi 0.2 m at 0.5 m/s on the average, then half a second of rest, a point each 10 ms.
  const double steps = std::ceil(2 * std::numbers::pi * 0.2 / 0.5 / 0.01) + 50;
  EXPECT_EQ(static_cast<double>(path.points_m.size()), steps + 1);
  // Counterclockwise about the normal.
  EXPECT_LT(path.points_m[100].x(), 1.4);
}

TEST(Path, AFileWithoutTimesHoldsPoints) {
  const ProblemFolder folder;
  folder.write("path.csv", "x_m, y_m,z_m\n1.4,0,0.9\n\n1.4,0.5,1\r\n");
  const TestCase path = load_path("[path]\nkind = 'file'\nfile = 'path.csv'\n", folder);
  EXPECT_FALSE(path.continuous);
  EXPECT_EQ(path.points_m, (std::vector<Eigen::Vector3d>{{1.4, 0, 0.9}, {1.4, 0.5, 1}}));
  EXPECT_TRUE(folder.load("p.toml").input_hashes.contains("path.csv"));
}

TEST(Path, AFileWithTimesIsGoneThroughAtThem) {
  TrackingTask task;
  task.rest_s = 0.02;
  const TestCase path = parse_path(
      "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n"
      "5,1,0,0,1,0,0,0\n"
      "5.02,1.2,0,0,1,0,0,0\n"
      "5.04,1.2,0.4,0,0,0,0,1\n",
      "p.csv", task);
  EXPECT_TRUE(path.continuous);
  ASSERT_EQ(path.points_m.size(), 7U);  // four steps, and two of rest
  const std::vector<Eigen::Vector3d> expected = {{1, 0, 0},     {1.1, 0, 0},   {1.2, 0, 0},
                                                 {1.2, 0.2, 0}, {1.2, 0.4, 0}, {1.2, 0.4, 0},
                                                 {1.2, 0.4, 0}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT((path.points_m[i] - expected[i]).norm(), 1e-9) << i;
  }
  const Eigen::Quaterniond start(1, 0, 0, 0);
  EXPECT_NEAR(path.turns[3].angularDistance(start), std::numbers::pi / 2, 1e-6);
  EXPECT_NEAR(path.turns[4].angularDistance(start), std::numbers::pi, 1e-6);
}

struct BadPath {
  std::string text;
  std::string message;
};

void PrintTo(const BadPath& bad, std::ostream* out) {
  *out << bad.text;
}

class BadPathFile : public testing::TestWithParam<BadPath> {};

TEST_P(BadPathFile, IsRefusedWithItsLine) {
  const std::string said =
      error_of(ErrorKind::bad_data, [] { parse_path(GetParam().text, "p.csv", {}); });
  EXPECT_THAT(said, testing::StartsWith(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Path, BadPathFile,
    testing::Values(
        BadPath{"", "p.csv: has 0 rows; a path needs two or more under a line of column names"},
        BadPath{"x_m,y_m\n1,2\n", "p.csv:1: there is no column 'z_m'; the columns of a path are"},
        BadPath{"x_m,y_m,z_m,speed\n", "p.csv:1: there is an unknown column 'speed'"},
        BadPath{"x_m,y_m,z_m,x_m\n", "p.csv:1: column 'x_m' stands there twice"},
        BadPath{"x_m,y_m,z_m,qw\n", "p.csv:1: an orientation needs all its columns"},
        BadPath{"x_m,y_m,z_m\n1,2,3\n1,2\n", "p.csv:3: there are 2 fields for 3 columns"},
        BadPath{"x_m,y_m,z_m\n1,2,3\n1,2,nan\n", "p.csv:3: 'nan' is not a finite number"},
        BadPath{"x_m,y_m,z_m\n1,2,3\n", "p.csv: has 1 rows; a path needs two"},
        BadPath{"x_m,y_m,z_m\n1400,0,900\n1,2,3\n",
                "p.csv:2: the place (1400, 0, 900) m is too far away; positions are in metres"},
        BadPath{"x_m,y_m,z_m\n1,2,3\n1,2,3\n", "p.csv:3: the same place as the row before"},
        BadPath{"time_s,x_m,y_m,z_m\n0,1,2,3\n0,1,2,4\n",
                "p.csv:3: time_s is 0 after 0; it must rise from row to row"},
        BadPath{"x_m,y_m,z_m,qw,qx,qy,qz\n1,2,3,0,0,0,0.1\n",
                "p.csv:2: the quaternion has the length 0.1; it must be a unit quaternion"}));

TEST(Path, ThatTurnsTheToolMakesItsOrientationCount) {
  const ProblemFolder folder;
  const auto load = [&](const std::string& task) {
    folder.write("p.toml",
                 "kind = 'tracking'\n[robot]\nurdf = 'irb4600_six'\n[variables]\n"
                 "start = 'proposed'\n[task]\n" +
                     task +
                     "[path]\nkind = 'points'\n"
                     "[[path.point]]\nposition_m = [1.4, 0, 0.9]\nrpy_rad = [0, 3.1, 0]\n"
                     "[[path.point]]\nposition_m = [1.4, 0.3, 0.9]\nrpy_rad = [0, 3.1, 0.2]\n");
    return folder.load("p.toml");
  };
  const LoadedProblem open = load("");
  EXPECT_EQ(open.tracking()->config().task.tool.orientation, ToolOrientation::pose);
  EXPECT_THAT(open.resolved_json, testing::HasSubstr("\"orientation\":\"pose\""));
  EXPECT_EQ(load("orientation = 'pointing'\n").tracking()->config().task.tool.orientation,
            ToolOrientation::pointing);
  EXPECT_THAT(
      folder.shorten(usage_error_of([&] { load("orientation = 'free'\n"); })),
      testing::AllOf(testing::StartsWith("p.toml:9: path.kind is 'points'; the path says how "
                                         "the tool is turned, which does not count where "
                                         "task.orientation is \"free\""),
                     testing::HasSubstr("or leave it out")));
  EXPECT_THAT(usage_error_of([&] { load("kinematics = 'palletiser'\n"); }),
              testing::HasSubstr("the closed form of a palletiser says nothing of that"));
}

class BadPathTable : public testing::TestWithParam<BadPath> {};

TEST_P(BadPathTable, IsRefusedWithItsKey) {
  EXPECT_THAT(ProblemFolder().refusal_of_base_with(GetParam().text),
              testing::StartsWith("p.toml:" + GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Path, BadPathTable,
    testing::Values(
        BadPath{"[path]\nkind = 'spiral'", "3: unknown path.kind 'spiral'"},
        BadPath{"[path]\nkind = 'points'", "2: path.point is missing"},
        BadPath{"[path]\nkind = 'line'\nfrom_m = [1, 0]\nto_m = [1, 0, 0]",
                "4: path.from_m is [1, 0]; it must be three numbers: x, y and z in metres"},
        BadPath{"[path]\nkind = 'line'\nfrom_m = [1, 0, 1]\nto_m = [1, 0, 1]",
                "3: path.kind is 'line'; point 1"},
        BadPath{"[path]\nkind = 'circle'\ncentre_m = [1, 0, 1]\nnormal = [0, 0, 0]\nradius_m = 1",
                "5: path.normal is [0, 0, 0]; it must point somewhere"},
        BadPath{"[path]\nkind = 'file'\nfile = 'none.csv'",
                "4: path.file is 'none.csv'; there is no such file"},
        BadPath{"[path]\nkind = 'points'\n[[path.point]]\nposition_m = [1, 0, 1]\nrpy_rad = [0, 0, "
                "0]\n[[path.point]]\nposition_m = [1, 0.5, 1]",
                "4: path.point is"}));

// What the arm's joints cannot do is said before anything is simulated, and refused if it must not
// be.
TEST(PathSurvey, SaysWhatTheJointsCannotDo) {
  const ProblemFolder folder;
  folder.write("p.toml",
               "extends = \"base\"\n[path]\nkind = 'line'\nfrom_m = [1.4, -0.7, 0.9]\n"
               "to_m = [1.4, 0.7, 0.9]\n[task]\nspeed_m_per_s = 4\n");
  const auto check = [&](const std::string& limits) {
    return check_paths(folder.load("p.toml", std::vector<std::string>{"task.limits=" + limits}));
  };
  EXPECT_THAT(check("ignore"), testing::IsEmpty());
  EXPECT_THAT(check("warn"),
              testing::ElementsAre(
                  testing::AllOf(testing::StartsWith("case 0 of train/1, on the way to point "),
                                 testing::HasSubstr("joint 1 ('joint_1') would have to move at")),
                  testing::StartsWith("1 of 1 paths looked at ask for more than the arm's joints "
                                      "can do; they are simulated all the same")));
  const std::string refused = error_of(ErrorKind::bad_data, [&] { check("enforce"); });
  EXPECT_THAT(refused, testing::AllOf(testing::HasSubstr("lower task.speed_m_per_s"),
                                      testing::HasSubstr("joint 1 ('joint_1')")));
  EXPECT_THAT(
      check_paths(folder.load(
          "p.toml", std::vector<std::string>{"task.limits=enforce", "task.speed_m_per_s=0.3"})),
      testing::IsEmpty());
}

}  // namespace
}  // namespace armwright
