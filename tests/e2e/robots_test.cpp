// Everybody's robot: from a URDF to tuned controllers with one command and nothing else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "sim/generated_arm.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// What keeps the tests short: few cases, few simulations.
const std::vector<std::string> kSmall = {
    "--set", "sets.validation_cases=4", "--set",  "sets.test_cases=6", "--set", "schedule.cases=4",
    "--set", "physics.substeps=4",      "--quiet"};

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

INSTANTIATE_TEST_SUITE_P(E2e, GeneratedRobots, testing::Range(0, kGeneratedArms));

class ShippedRobots : public Robots, public testing::WithParamInterface<const char*> {};

TEST_P(ShippedRobots, GoFromUrdfToTunedControllersWithOneCommand) {
  std::vector<std::string> words = {"--robot", GetParam()};
  if (std::string(GetParam()) == "arm7_gripper") {
    words.insert(words.begin(), {"--tip", "tool"});
  }
  expect_tuned(words);
}

INSTANTIATE_TEST_SUITE_P(E2e, ShippedRobots,
                         testing::Values("irb4600_40_255", "irb4600_six", "planar2", "arm7",
                                         "arm7_gripper"));

TEST_F(Robots, ThatSlideGoThatWayToo) {
  write("scara.urdf", kScara);
  expect_tuned({"--robot", "scara.urdf"});
}

// Drives that take velocities or positions. Their start is good already.
TEST_F(Robots, WithDrivesOfAnyInterfaceAreTuned) {
  for (const char* interface : {"control.interface=velocity", "control.interface=position"}) {
    expect_tuned({"--robot", "irb4600_six", "--set", interface}, 0.5);
  }
}

}  // namespace
}  // namespace armwright
