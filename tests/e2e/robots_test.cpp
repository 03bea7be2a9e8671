// Everybody's robot: from a URDF to tuned controllers with one command and nothing else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "sample_or_all.hpp"
#include "sim/generated_arm.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// What keeps the tests short: few cases, few simulations. Designs of few training cases may be good
// by chance, so the winner is chosen on more.
const std::vector<std::string> kSmall = {
    "--set", "sets.validation_cases=16", "--set",  "sets.test_cases=6", "--set", "schedule.cases=4",
    "--set", "physics.substeps=4",       "--quiet"};

// An arm as they stand in assembly lines: two joints that turn in the plane, one that slides, one
// without end.
constexpr const char* kScara = R"(<robot name="scara"><link name="base"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="a"/>
  <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
  <limit lower="-2.3" upper="2.3" velocity="4" effort="100"/></joint>
<link name="a"><inertial><origin xyz="0.15 0 0"/><mass value="6"/>
  <inertia ixx="0.02" iyy="0.07" izz="0.07" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="elbow" type="revolute"><parent link="a"/><child link="b"/>
  <origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-2.5" upper="2.5" velocity="6" effort="50"/></joint>
<link name="b"><inertial><origin xyz="0.12 0 0"/><mass value="4"/>
  <inertia ixx="0.01" iyy="0.04" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="quill" type="prismatic"><parent link="b"/><child link="c"/>
  <origin xyz="0.25 0 0"/><axis xyz="0 0 -1"/>
  <limit lower="0" upper="0.25" velocity="1" effort="150"/></joint>
<link name="c"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/>
  <inertia ixx="0.005" iyy="0.005" izz="0.0005" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="roll" type="continuous"><parent link="c"/><child link="d"/>
  <origin xyz="0 0 -0.2"/><axis xyz="0 0 1"/></joint>
<link name="d"><inertial><mass value="0.3"/>
  <inertia ixx="0.0003" iyy="0.0003" izz="0.0003" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="flange" type="fixed"><parent link="d"/><child link="tip"/>
  <origin xyz="0 0 -0.05"/></joint>
<link name="tip"/></robot>
)";

class Robots : public testing::Test {
 protected:
  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), kSmall.begin(), kSmall.end());
    return run_program(folder_.path(), arguments);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  // Tuned in one go, its error on unseen paths is far below that of what was proposed: at most this
  // share of it.
  void expect_tuned(const std::vector<std::string>& robot, double share = 0.2) const {
    std::vector<std::string> tune = {"optimize"};
    std::vector<std::string> start = {"evaluate", "start", "--json"};
    tune.insert(tune.end(), robot.begin(), robot.end());
    start.insert(start.end(), robot.begin(), robot.end());
    tune.insert(tune.end(), {"--budget", "1500", "--json", "--out", "tuned/" + robot.back()});
    const Outcome before = run(start);
    ASSERT_EQ(before.exit_code, 0) << before.err;
    const Outcome after = run(tune);
    ASSERT_EQ(after.exit_code, 0) << after.err;
    const json proposed = json::parse(before.out).at("summary");
    const json tuned = json::parse(after.out).at("winner").at("test_summary");
    EXPECT_EQ(proposed.at("without_number"), 0);
    EXPECT_EQ(tuned.at("failures"), 0) << robot.back();
    EXPECT_LT(tuned.at("mean").get<double>(), share * proposed.at("mean_error_m").get<double>())
        << robot.back();
  }

  TemporaryFolder folder_;
};

class GeneratedRobots : public Robots, public testing::WithParamInterface<int> {};

TEST_P(GeneratedRobots, GoFromUrdfToTunedControllersWithOneCommand) {
  const std::string name = "arm_" + std::to_string(GetParam()) + ".urdf";
  write(name, make_arm_urdf(GetParam()));
  expect_tuned({"--robot", name});
}

// One of each number of joints.
INSTANTIATE_TEST_SUITE_P(E2e, GeneratedRobots, testing::Values(0));
INSTANTIATE_TEST_SUITE_P(Long, GeneratedRobots, testing::Range(1, 5));

class ShippedRobots : public Robots, public testing::WithParamInterface<const char*> {};

TEST_P(ShippedRobots, GoFromUrdfToTunedControllersWithOneCommand) {
  expect_tuned({"--robot", GetParam()});
}

INSTANTIATE_TEST_SUITE_P(E2e, ShippedRobots, testing::Values("kr300"));
INSTANTIATE_TEST_SUITE_P(Long, ShippedRobots,
                         testing::Values("irb4600_40_255", "irb4600_six", "planar2", "arm7",
                                         "arm7_gripper"));

TEST_F(Robots, ThatSlideGoThatWayToo) {
  write("scara.urdf", kScara);
  expect_tuned({"--robot", "scara.urdf"});
  // Newtons are not added to newton metres.
  const json result = json::parse(read_text(folder_.path() / "tuned/scara.urdf/result.json"));
  const json efforts = result.at("winner").at("efforts");
  EXPECT_EQ(efforts.at("total_force_n"), 150);
  EXPECT_GT(efforts.at("total_torque_n_m"), 150);
  const auto names = result.at("metrics").get<std::vector<std::string>>();
  const auto at =
      static_cast<std::size_t>(std::ranges::find(names, "total_torque") - names.begin());
  EXPECT_DOUBLE_EQ(efforts.at("total_torque_n_m").get<double>() + 150,
                   result.at("winner").at("test").at("metrics").at(at).get<double>());
  const Outcome shown = run_program(folder_.path(), {"show", "tuned/scara.urdf"});
  EXPECT_THAT(shown.out, testing::AllOf(testing::HasSubstr("  total force           150.0 N"),
                                        testing::HasSubstr("  error while moving    RMS ")));
  const Outcome evaluated =
      run({"evaluate", "tuned/scara.urdf/winner.toml", "--robot", "scara.urdf", "--json"});
  const json summary = json::parse(evaluated.out).at("summary");
  EXPECT_EQ(summary.at("total_force_n"), 150);
  EXPECT_EQ(summary.at("total_torque_n_m"), efforts.at("total_torque_n_m"));
  const json motion = result.at("winner").at("test_motion");
  for (const char* key :
       {"error_while_moving_rms_m", "error_while_moving_peak_m", "error_after_start_up_m"}) {
    EXPECT_EQ(summary.at(key), motion.at(key)) << key;
  }
}

// The controllers hold the arm from the first period on, unless they are told to start empty.
TEST_F(Robots, DoNotSagWhenTheyAreEnabled) {
  const auto evaluate = [&](const std::string& start) {
    const Outcome outcome = run({"evaluate", "start", "--robot", "arm7", "--json", "--set",
                                 "task.speed_m_per_s=0.02", "--set", "control.start=" + start});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out).at("summary").at("error_after_start_up_m").get<double>();
  };
  const double empty_m = evaluate("empty");
  EXPECT_GT(empty_m, 0.05);
  EXPECT_LT(evaluate("gravity"), empty_m / 10);
}

// The data sheet says how the run was made and how its winner is simulated again.
TEST_F(Robots, HaveADatasheetWithBothCommands) {
  const std::vector<std::string> made = {"optimize", "--robot", "planar2", "--budget", "40"};
  std::vector<std::string> words = made;
  words.insert(words.end(), {"--out", "planar"});
  ASSERT_EQ(run(words).exit_code, 0);
  const Outcome outcome =
      run_program(folder_.path(), {"export", "planar", "--format", "datasheet", "--out", "sheet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string html = read_text(folder_.path() / "sheet/datasheet.html");
  EXPECT_THAT(html,
              testing::HasSubstr("To make it: armwright optimize --robot planar2 --budget 40"));
  EXPECT_THAT(html, testing::ContainsRegex("To simulate it again: armwright evaluate winner.toml "
                                           "--problem robot --set .*planar2.urdf"));
  EXPECT_THAT(html, testing::HasSubstr("start with integrals that hold the arm against gravity"));
}

// Two joints that turn and one that slides, with its motors in a file of their own.
constexpr const char* kMjcf = R"(<mujoco model="mast"><compiler angle="radian"/>
<default><joint damping="0.5" armature="0.02"/></default>
<worldbody><body name="mast" pos="0 0 0.5">
  <joint name="turn" axis="0 0 1" range="-2.5 2.5"/>
  <inertial pos="0 0 0.1" mass="5" diaginertia="0.05 0.05 0.03"/>
  <body name="boom" pos="0 0 0.3"><joint name="lift" axis="0 1 0" range="-1 1"/>
    <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.03"/>
    <body name="reach" pos="0.5 0 0"><joint name="slide" type="slide" axis="1 0 0" range="0 0.3"/>
      <geom type="box" pos="0.1 0 0" size="0.1 0.02 0.02"/><site name="tool" pos="0.2 0 0"/>
    </body></body></body></worldbody>
<include file="motors.xml"/></mujoco>
)";
constexpr const char* kMotors = R"(<mujoco><actuator>
<motor joint="turn" ctrlrange="-60 60"/><motor joint="lift" ctrlrange="-9 9" gear="10"/>
<motor joint="slide" ctrlrange="-200 200"/></actuator></mujoco>
)";

TEST_F(Robots, InMjcfGoThatWayTooAndTheirFilesAreInputs) {
  write("arm.xml", kMjcf);
  write("motors.xml", kMotors);
  write("arm.plant.toml", "[joint.slide]\ncoulomb_n = 3\n");
  if (!std::filesystem::exists(ARMWRIGHT_TEST_LIBRARIES "/libcart_pole.so")) {
    GTEST_SKIP() << "armwright was built without MuJoCo";
  }
  const Outcome list = run_program(folder_.path(), {"list", "robots", "arm.xml", "--json"});
  ASSERT_EQ(list.exit_code, 0) << list.err;
  const json arm = json::parse(list.out);
  EXPECT_EQ(arm.at("name"), "mast");
  EXPECT_EQ(arm.at("joints").at(1).at("effort_limit_n_m"), 90);
  EXPECT_EQ(arm.at("joints").at(1).at("plant").at("armature_kg_m2"), 0.02);
  EXPECT_EQ(arm.at("joints").at(2).at("plant").at("coulomb_n"), 3);
  const std::vector<std::string> tune = {"optimize", "--robot", "arm.xml", "--tip", "tool",
                                         "--budget", "120",     "--out",   "run"};
  const Outcome tuned = run(tune);
  ASSERT_EQ(tuned.exit_code, 0) << tuned.err;
  std::ifstream manifest(folder_.path() / "run/manifest.json");
  const json inputs = json::parse(manifest).at("configuration").at("inputs");
  for (const char* file : {"arm.xml", "motors.xml", "arm.plant.toml"}) {
    EXPECT_TRUE(inputs.contains(file)) << file;
  }
  const auto export_as = [&](const std::string& format) {
    return run_program(folder_.path(), {"export", "run", "--format", format, "--out", format});
  };
  const Outcome urdf = export_as("urdf");
  EXPECT_EQ(urdf.exit_code, 2);
  EXPECT_THAT(urdf.err, HasSubstr("arm.xml), and the format urdf changes the limits of a URDF; "
                                  "ros2-control and datasheet can be exported"));
  const Outcome datasheet = export_as("datasheet");
  EXPECT_EQ(datasheet.exit_code, 0) << datasheet.err;
  write("motors.xml", std::string(kMotors) + "<!-- other -->");
  const Outcome changed = export_as("ros2-control");
  EXPECT_EQ(changed.exit_code, 4);
  EXPECT_THAT(changed.err, HasSubstr("have changed since the run: motors.xml"));
}

// Drives that take velocities or positions. Their start is good already.
TEST_F(Robots, WithDrivesOfAnyInterfaceAreTuned) {
  for (const char* interface : sample_or_all<std::vector<const char*>>(
           {"control.interface=velocity"},
           {"control.interface=velocity", "control.interface=position"})) {
    expect_tuned({"--robot", "irb4600_six", "--set", interface}, 0.5);
  }
}

}  // namespace
}  // namespace armwright
