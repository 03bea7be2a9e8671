// What a user reads whose file is not there, is not what it should be, or does not fit the others.
#include <gmock/gmock.h>
#include <stdlib.h>

#include "base/file.hpp"
#include "problems/config/config_files.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

constexpr const char* kProblems =
    "abdessemed-fuzzy, ackley, bbob-f1, bbob-f10, bbob-f15, bbob-f2, bbob-f3, bbob-f8, "
    "branin, chaiyaratana-line, co-design, constrained, dtlz2, ellipsoid, ellipsoid-int, excite, "
    "faithful-e6, "
    "faithful-q1, faithful-q3, gasparetto, gasparetto-front, hartmann6, identify, initial, "
    "initial-0cm, initial-45cm, initial-90cm, irb4600, q1-complex, q1-ramp, q1-requirements, "
    "q1-step, "
    "q1-trapezoid, q1-triangular, q2-e1, q2-e2, q2-e3, q2-e4, q2-e5, q2-e6, q2-energy, "
    "q2-error, q2-pareto, q2-torque, q3-load, q4-speed, rastrigin, robot, robust-e6, "
    "robust-q1, robust-q3, rosenbrock, saravanan-puma, shiakolas, sphere, sphere-int, "
    "subudhi-flexible, zdt1";
constexpr const char* kOrPath = " (or the path of a .toml file)";

std::string problem_refusal(const std::string& name) {
  return usage_error_of([&] { load_problem(name); });
}
std::string design_refusal(const std::string& name) {
  return usage_error_of([&] { load_design(name); });
}

std::string list_nearest_problems(const std::string& typed) {
  return list_near(typed, kProblems, "armwright list problems");
}

TEST(BadName, UnknownProblemNamesTheNearestOnes) {
  EXPECT_EQ(problem_refusal("q1-complx"),
            "unknown problem 'q1-complx'; did you mean 'q1-complex'? Valid: " +
                list_nearest_problems("q1-complx") + kOrPath);
  EXPECT_THAT(list_nearest_problems("q1-complx"),
              testing::AllOf(testing::StartsWith("q1-complex, "),
                             testing::EndsWith(" more, which 'armwright list problems' lists")));
  EXPECT_EQ(problem_refusal("walking"),
            "unknown problem 'walking'. Valid: " + list_nearest_problems("walking") + kOrPath);
  EXPECT_EQ(problem_refusal(""),
            "unknown problem ''. Valid: " + list_nearest_problems("") + kOrPath);
  // What is only there to be extended is no problem.
  EXPECT_EQ(problem_refusal("_thesis"),
            "unknown problem '_thesis'. Valid: " + list_nearest_problems("_thesis") + kOrPath);
  EXPECT_EQ(problem_refusal("q1\x1b[31m"),
            "unknown problem 'q1?[31m'. Valid: " + list_nearest_problems("q1\x1b[31m") + kOrPath);
}

TEST(BadName, UnknownDesignNamesTheNearestOnes) {
  EXPECT_EQ(design_refusal("tabel-a5"),
            "unknown design 'tabel-a5'; did you mean 'table-a5'? Valid: " +
                list_designs("tabel-a5") + kOrPath);
  EXPECT_EQ(design_refusal("q1-complex"),
            "unknown design 'q1-complex'. Valid: " + list_designs("q1-complex") + kOrPath);
}

TEST(BadName, AProgramOfTheUserNeedsExec) {
  for (const char* name : {"mine.py", "./mine.py", "python3 mine.py", "python3"}) {
    EXPECT_EQ(problem_refusal(name),
              std::string("unknown problem '") + name +
                  "'; a program of your own needs exec: before its command, as in \"exec:python3 "
                  "mine.py\"");
  }
}

TEST(BadName, UnknownRobotIsNamedWhereTheProblemNamesIt) {
  EXPECT_EQ(ProblemFolder().refusal_of_base_with("[robot]\nurdf = 'irb4600_40_254'"),
            "p.toml:3: robot.urdf is 'irb4600_40_254'; unknown robot 'irb4600_40_254'; did you "
            "mean 'irb4600_40_255'? Valid: arm7, arm7_gripper, irb4600_40_255, irb4600_six, kr300, "
            "planar2, puma560, subudhi_flexible, three_rods, two_tubes (or the path of a .urdf or "
            ".xml file)");
}

TEST(BadPath, SaysWhereItWasLookedFor) {
  const ProblemFolder folder;
  EXPECT_EQ(problem_refusal("no-such-file.toml"),
            "there is no file 'no-such-file.toml' in the current folder, and no shipped problem "
            "has that name");
  EXPECT_EQ(problem_refusal("q1-complx.toml"),
            "there is no file 'q1-complx.toml' in the current folder, and no shipped problem has "
            "that name; did you mean 'q1-complex'?");
  EXPECT_EQ(problem_refusal("./solve --fast"),
            "there is no file './solve --fast' in the current folder; the name of a program begins "
            "with exec:, as in 'exec:./solve --fast'");
  EXPECT_EQ(design_refusal("no-such-folder/d.toml"),
            "there is no file 'no-such-folder/d.toml' in the current folder");
  EXPECT_EQ(folder.shorten(problem_refusal(folder.path("q1.toml"))), "there is no file 'q1.toml'");
  EXPECT_EQ(folder.shorten(problem_refusal(folder.path("base"))),
            "there is no file 'base'; did you mean 'base.toml'?");
  EXPECT_EQ(folder.shorten(problem_refusal(folder.path(""))),
            "'' is a folder; name a .toml file in it");
}

TEST(BadPath, OfAFileThatAProblemNames) {
  const ProblemFolder folder;
  EXPECT_EQ(
      folder.refusal_of_base_with("[robot]\nurdf = 'welder.urdf'"),
      "p.toml:3: robot.urdf is 'welder.urdf'; there is no file 'welder.urdf' in FOLDER or in the "
      "current folder, and no shipped robot has that name");
  EXPECT_EQ(folder.refusal_of_base_with("[robot]\nurdf = 'arms/arm.urdf'"),
            "p.toml:3: robot.urdf is 'arms/arm.urdf'; there is no file 'arms/arm.urdf' in FOLDER "
            "or in the current folder");
  EXPECT_EQ(folder.refusal_of_base_with("[robot]\nurdf = 4600"),
            "p.toml:3: robot.urdf is 4600, an integer; it must be a string");
  EXPECT_EQ(folder.refusal_of_base_with("[variables]\nstart = 'mine.toml'"),
            "p.toml:3: variables.start is 'mine.toml'; there is no file 'mine.toml' in FOLDER or "
            "in the current folder, and no shipped design has that name");
}

TEST(NamedFile, IsFoundBesideTheProblemThatNamesIt) {
  // The current folder of the test has neither file.
  const ProblemFolder folder;
  std::string design;
  for (int joint = 0; joint < 4; ++joint) {
    design += make_joint("p_n_m_per_rad = " + std::to_string(100 + joint));
  }
  folder.write("mine.toml", design);
  folder.write("arm.urdf", read_file(resolve_config("robots", "irb4600_40_255"), 1 << 20));
  folder.write("p.toml",
               "extends = \"base\"\n[robot]\nurdf = 'arm.urdf'\n[variables]\nstart = 'mine.toml'\n"
               "[sweep]\nparameter = 'task.load_kg'\nvalues = [1, 2]\ndesign = './mine.toml'\n"
               "[published]\ndesign = 'mine.toml'\n");
  const LoadedProblem loaded = folder.load("p.toml");
  EXPECT_EQ(loaded.tracking()->config().start.joints.at(3).gains.at(0), 103);
  EXPECT_THAT(loaded.input_hashes,
              testing::UnorderedElementsAre(testing::Key("arm.urdf"), testing::Key("mine.toml")));
  // Whoever reads the design later finds it from anywhere.
  EXPECT_EQ(load_design(loaded.sweep->design).design.joints.at(2).gains.at(0), 102);
  EXPECT_EQ(load_design(loaded.published.design).design.joints.at(1).gains.at(0), 101);
}

TEST(NamedFile, OfTheShippedOnesMayHaveItsExtension) {
  EXPECT_EQ(resolve_config("robots", "irb4600_40_255.urdf"),
            resolve_config("robots", "irb4600_40_255"));
  EXPECT_EQ(load_design("table-a5.toml").name, "table-a5");
}

TEST(NamedFile, OfAPlantIsNoRobot) {
  const ProblemFolder folder;
  EXPECT_THAT(folder.refusal_of_base_with("[robot]\nplant = 'arm7'\n"),
              testing::HasSubstr("p.toml:3: robot.plant is 'arm7'; unknown plant 'arm7'. Valid: "
                                 "irb4600_geared.plant, kr300.plant, puma560.plant, "
                                 "subudhi_flexible.plant "
                                 "(or the path of a .toml file)"));
  EXPECT_THAT(folder.refusal_of_base_with("[robot]\nurdf = 'mine.toml'\n"),
              testing::HasSubstr("p.toml:3: robot.urdf is 'mine.toml'; unknown robot 'mine.toml'"));
}

TEST(BadExtends, NamesTheChain) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.refusal_of("extends = \"p\""),
            "p.toml:1: extends is \"p\"; the files extend each other in a circle: p.toml -> "
            "p.toml");
  folder.write("q.toml", "# two lines\nextends = \"p\"\n");
  EXPECT_EQ(folder.refusal_of("extends = \"q\""),
            "q.toml:2: extends is \"p\"; the files extend each other in a circle: p.toml -> "
            "q.toml -> p.toml");
  EXPECT_THAT(folder.refusal_of("extends = \"bse\""),
              testing::StartsWith("p.toml:1: unknown file to extend 'bse'; did you mean 'base'? "
                                  "Valid: base, q, "));
}

TEST(BadExtends, MistakeInTheExtendedFileIsNamedThere) {
  const ProblemFolder folder;
  folder.write("q.toml", "extends = \"base\"\n[task]\nspeed_m_per_s = 0\n");
  EXPECT_EQ(folder.refusal_of("extends = \"q\"\n[task]\nload_kg = 1\n"),
            "q.toml:3: task.speed_m_per_s is 0; it must be a finite number >= 0.0001 and <= 100");
}

TEST(BadRobot, FileIsNamedWithItsLine) {
  const ProblemFolder folder;
  folder.write("arm.urdf", "<robot name='x'>\n<link name='a'>\n</robot>\n");
  folder.write("p.toml", "extends = \"base\"\n[robot]\nurdf = 'arm.urdf'\n");
  EXPECT_THAT(folder.shorten(error_of(ErrorKind::bad_data, [&] { folder.load("p.toml"); })),
              testing::StartsWith("arm.urdf:"));
}

TEST(BadRobot, ThatDoesNotSuitTheTaskIsNamedWithItsFile) {
  const ProblemFolder folder;
  folder.write("arm.urdf",
               read_file(std::string(ARMWRIGHT_TEST_DATA) + "/urdf/two_joints.urdf", 1 << 20));
  folder.write("two.toml", make_joint() + make_joint());
  folder.write("p.toml",
               "extends = \"base\"\n[robot]\nurdf = 'arm.urdf'\n[variables]\nstart = 'two.toml'\n"
               "[task]\nkinematics = 'palletiser'\n");
  EXPECT_THAT(folder.shorten(error_of(ErrorKind::bad_data, [&] { folder.load("p.toml"); })),
              testing::AllOf(testing::StartsWith("arm.urdf: robot '"),
                             testing::HasSubstr("it has 2 moving joints; it must have 4")));
}

TEST(BadDesign, DoesNotFitTheRobot) {
  const ProblemFolder folder;
  folder.write("three.toml", make_joint() + make_joint() + make_joint());
  EXPECT_EQ(
      folder.refusal_of_base_with("[variables]\nstart = 'three.toml'"),
      "p.toml:3: variables.start is 'three.toml'; that design has 3 joints and robot "
      "'irb4600_40_255' has 4; designs are made for one robot: take another robot.urdf, or start "
      "from a design made for this one (variables.start=proposed makes one)");
  EXPECT_EQ(folder.refusal_of_base_with(
                "[sweep]\nparameter = 'task.load_kg'\nvalues = [1]\ndesign = 'three.toml'"),
            "p.toml:5: sweep.design is 'three.toml'; the design has 3 joints, the robot "
            "irb4600_40_255 of problem p has 4; use a design made for this robot");
}

TEST(BadDesign, ZeroIsNoStartForAVariable) {
  const ProblemFolder folder;
  const std::string without_integral = make_joint("p_n_m_per_rad = 300", "i_n_m_per_rad_s = 0");
  folder.write("d.toml", make_joint() + without_integral + make_joint() + make_joint());
  EXPECT_EQ(folder.refusal_of_base_with("[variables]\nstart = 'd.toml'"),
            "p.toml:3: variables.start is 'd.toml'; joint_2.i starts at 0, but a variable spans a "
            "factor around its start value; give it another value in the design or leave it out "
            "of 'optimize'");
  // As the message says: left out, it stays 0.
  folder.write("p.toml",
               "extends = \"base\"\n[variables]\nstart = 'd.toml'\n"
               "[[variables.joint]]\nname = 'joint_2'\noptimize = ['p', 'd']\n");
  const LoadedProblem loaded = folder.load("p.toml");
  EXPECT_EQ(loaded.tracking()->config().start.joints.at(1).gains.at(1), 0);
}

TEST(BadDesign, EveryMistakeInItsFileHasItsPlace) {
  const ProblemFolder folder;
  const std::string must = "; it must be a finite number ";
  EXPECT_EQ(folder.refusal_of_design(""),
            "d.toml:1: joint is missing; it must be an array of tables, [[joint]]");
  EXPECT_EQ(folder.refusal_of_design("joint = []"),
            "d.toml:1: joint is []; a design must have at least one joint, [[joint]]");
  EXPECT_EQ(folder.refusal_of_design("[joint]\np_n_m_per_rad = 1"),
            "d.toml:1: joint is a table; it must be an array of tables, [[joint]]");
  EXPECT_EQ(folder.refusal_of_design(make_joint() + make_joint("p_n_m_per_rad = -1")),
            "d.toml:8: joint[1].p_n_m_per_rad is -1" + must + ">= 0");
  EXPECT_EQ(folder.refusal_of_design(make_joint("p_n_m_per_rad = nan")),
            "d.toml:2: joint[0].p_n_m_per_rad is nan; it must be a finite number");
  EXPECT_EQ(folder.refusal_of_design(make_joint("p_n_m_per_rad = '3'")),
            "d.toml:2: joint[0].p_n_m_per_rad is '3', a string" + must + ">= 0");
  EXPECT_EQ(folder.refusal_of_design(make_joint("p = 3")),
            "d.toml:1: joint[0].p_n_m_per_rad is missing" + must +
                ">= 0 (is joint[0].p in d.toml:2 meant?)");
  EXPECT_EQ(folder.refusal_of_design(make_joint("p_n_m_per_rad = 1", "i_n_m_per_rad_s = -2")),
            "d.toml:3: joint[0].i_n_m_per_rad_s is -2" + must + ">= 0");
  EXPECT_EQ(folder.refusal_of_design(
                make_joint("p_n_m_per_rad = 1", "i_n_m_per_rad_s = 1", "d_n_m_s_per_rad = -0.5")),
            "d.toml:4: joint[0].d_n_m_s_per_rad is -0.5" + must + ">= 0");
  EXPECT_EQ(folder.refusal_of_design(make_joint("p_n_m_per_rad = 1", "i_n_m_per_rad_s = 1",
                                                "d_n_m_s_per_rad = 1", "effort_min_n_m = 200")),
            "d.toml:5: joint[0].effort_min_n_m is 200" + must + "<= 0");
  EXPECT_EQ(folder.refusal_of_design(make_joint("p_n_m_per_rad = 1", "i_n_m_per_rad_s = 1",
                                                "d_n_m_s_per_rad = 1", "effort_min_n_m = -200",
                                                "effort_max_n_m = -0.001")),
            "d.toml:6: joint[0].effort_max_n_m is -0.001" + must + ">= 0");
  EXPECT_EQ(folder.refusal_of_design("controller = 'pdi'\n" + make_joint()),
            "d.toml:1: unknown controller 'pdi'; did you mean 'pid'? Valid: pid, "
            "pid_filtered, pi2d, pid_gravity, pid_computed_torque, cascade, neural, fuzzy, "
            "fuzzy_reference, pid_velocity, pid_position");
  EXPECT_EQ(folder.refusal_of_design(make_joint() + "effort_n_m = 5\n"),
            "d.toml:7: unknown key joint[0].effort_n_m; did you mean 'joint[0].effort_min_n_m'? "
            "Valid here: name, p_n_m_per_rad, i_n_m_per_rad_s, d_n_m_s_per_rad, effort_min_n_m, "
            "effort_max_n_m, length_scale, section_scale, tube_diameter_m, tube_wall_m");
  EXPECT_EQ(folder.refusal_of_design(make_joint() + "[[published]]\nlabel = 'x'\n"),
            "d.toml:7: published[0].problem is missing; it must be a string");
  EXPECT_EQ(folder.refusal_of_design(
                make_joint() + "[[published]]\nlabel = 'x'\nproblem = 'q1-step'\nerror_m = 0\n"),
            "d.toml:10: published[0].error_m is 0" + must + "> 0");
}

class ConfigFolder : public testing::Test {
 protected:
  void TearDown() override { unsetenv("ARMWRIGHT_CONFIGS"); }
};

TEST_F(ConfigFolder, CanBeAnotherOne) {
  const ProblemFolder folder;
  for (const std::string kind : {"problems", "designs", "robots"}) {
    std::filesystem::create_directory(folder.path(kind));
  }
  folder.write("problems/mine.toml", "kind = 'analytic'\n[function]\nname = 'sphere'\n");
  folder.write("problems/_base.toml", "");
  folder.write("problems/notes.txt", "");
  ASSERT_EQ(setenv("ARMWRIGHT_CONFIGS", folder.path("").c_str(), 1), 0);
  EXPECT_THAT(list_configs("problems"), testing::ElementsAre("mine"));
  EXPECT_EQ(load_problem("mine").name, "mine");
  EXPECT_EQ(problem_refusal("mein"),
            "unknown problem 'mein'. Valid: mine (or the path of a .toml file)");
  EXPECT_EQ(design_refusal("table-a1"),
            "unknown design 'table-a1'. Valid: (none) (or the path of a .toml file)");
}

TEST_F(ConfigFolder, MustHoldProblems) {
  ASSERT_EQ(setenv("ARMWRIGHT_CONFIGS", "/no/such/folder", 1), 0);
  EXPECT_EQ(problem_refusal("sphere"),
            "ARMWRIGHT_CONFIGS is '/no/such/folder'; it must be a folder that holds problems/, "
            "designs/ and robots/");
}

}  // namespace
}  // namespace armwright
