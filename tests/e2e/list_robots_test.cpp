// `armwright list robots FILE`: what it shows of a file with blemishes, and the file that it mends.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Two links without masses, a flange that belongs to no joint, a mesh in a package, and a gripper.
constexpr const char* kArm = R"(<robot name="blemished">
  <link name="base_link"/>
  <joint name="foot" type="fixed"><parent link="base_link"/><child link="base"/></joint>
  <link name="base"/>
  <joint name="swing" type="revolute"><parent link="base_link"/><child link="upper"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="200"/></joint>
  <link name="upper">
    <visual><geometry><mesh filename="package://arm_meshes/upper.stl"/></geometry></visual>
    <visual><geometry><mesh filename="package://arm_meshes/cover.stl"/></geometry></visual>
  </link>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="80"/></joint>
  <link name="lower"/>
  <joint name="end" type="fixed"><parent link="lower"/><child link="plate"/>
    <origin xyz="0 0 0.4"/></joint>
  <link name="plate"/>
</robot>
)";

class ListRobots : public testing::Test {
 protected:
  ListRobots() { write("arm.urdf", kArm); }
  Outcome list(std::vector<std::string> words) const {
    words.insert(words.begin(), {"list", "robots"});
    return run_program(folder_.path(), words);
  }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    std::ofstream(folder_.path() / name) << text;
  }
  TemporaryFolder folder_;
};

TEST_F(ListRobots, ShowsChainMassesPictureRepairsAndNotes) {
  const Outcome outcome = list({"arm.urdf"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* part :
       {"blemished: arm.urdf\n", "upper  assumed ", "From 'base_link' to 'plate': 2 joints, ",
        "Side view at home: # base, 1 to 2 joints, * tip\n",
        "repaired: a moving link without <inertial> gets one: 'upper', 'lower'\n",
        "note: the tip is taken to be 'plate'; the other ends are 'base'; robot.tip or --tip",
        "note: 2 meshes were not found, e.g. package://arm_meshes/cover.stl; --package NAME=DIR"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  const json robot = json::parse(list({"arm.urdf", "--json"}).out);
  EXPECT_EQ(robot.at("base"), "base_link");
  EXPECT_EQ(robot.at("tip"), "plate");
  EXPECT_THAT(robot.at("ends"), ElementsAre("base", "plate"));
  EXPECT_THAT(robot.at("repairs"), ElementsAre(HasSubstr("'upper', 'lower'")));
  EXPECT_EQ(robot.at("joints")[0].at("mass_assumed"), true);
  EXPECT_EQ(robot.at("home").size(), 2);
  EXPECT_EQ(robot.at("missing_meshes").size(), 2);
}

// The mended file gives the same arm without repairs, also in its meshes' places.
TEST_F(ListRobots, WritesAFileThatNeedsNoRepair) {
  const json before = json::parse(list({"arm.urdf", "--json", "--write", "mended.urdf"}).out);
  const json after = json::parse(list({"mended.urdf", "--json"}).out);
  EXPECT_THAT(after.at("repairs"), IsEmpty());
  ASSERT_EQ(after.at("joints").size(), 2);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after.at("joints")[i].at("mass_kg"), before.at("joints")[i].at("mass_kg"));
    EXPECT_EQ(after.at("joints")[i].at("mass_assumed"), false);
  }
  const Outcome same = list({"arm.urdf", "--write", "./arm.urdf"});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_THAT(same.err, HasSubstr("--write ./arm.urdf: this is the file that is read"));
}

TEST_F(ListRobots, FindsThePackagesThatTheUserNames) {
  write("parts/upper.stl", "");
  write("parts/cover.stl", "");
  EXPECT_THAT(list({"arm.urdf", "--package", "arm_meshes=parts"}).out, Not(HasSubstr("not found")));
  EXPECT_THAT(list({"arm.urdf", "--package", "arm_meshes=nowhere"}).err,
              HasSubstr("--package is 'arm_meshes=nowhere'; it must be NAME=DIR with a folder that "
                        "exists"));
  EXPECT_THAT(
      list({"arm.urdf", "--package", "parts"}).err,
      HasSubstr("--package is 'parts'; it must be NAME=DIR, a package's name and its folder"));
}

TEST_F(ListRobots, TakesBaseAndTip) {
  const json robot = json::parse(list({"arm.urdf", "--base", "upper", "--json"}).out);
  EXPECT_EQ(robot.at("joints").size(), 1);
  EXPECT_EQ(robot.at("tip"), "plate");
  const Outcome outcome = list({"arm.urdf", "--base", "lower", "--tip", "upper"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("arm.urdf: the tip 'upper' is above the base 'lower'"));
  EXPECT_THAT(list({"--tip", "upper"}).err, HasSubstr("--tip is for one robot; name it"));
  EXPECT_THAT(run_program(folder_.path(), {"list", "problems", "q1", "--write", "x"}).err,
              HasSubstr("--write is for one robot; name it: list robots FILE --write ..."));
}

TEST_F(ListRobots, TellsAllThatMustBeMended) {
  write("bad.urdf", R"(<robot name="bad"><link name="a"/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/>
<limit lower="2" upper="1" velocity="-1" effort="1"/></joint>
<link name="b"><inertial><mass value="-1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial></link></robot>)");
  const Outcome outcome = list({"bad.urdf"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("bad.urdf: 3 things to mend\n"),
                                 HasSubstr("bad.urdf:3: joint 'j': <limit>: lower is 2"),
                                 HasSubstr("bad.urdf:3: joint 'j': <limit>: velocity is -1"),
                                 HasSubstr("bad.urdf:4: link 'b': <mass>: value is -1")));
}

}  // namespace
}  // namespace armwright
