// [robot] of a problem: which part of a URDF it simulates.
#include <gmock/gmock.h>

#include <tuple>

#include "base/file.hpp"
#include "base/hash.hpp"
#include "problems/config/config_files.hpp"
#include "problems/problem_folder.hpp"
#include "sim/robot/mesh_file.hpp"

namespace armwright {
namespace {

using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

// The shipped arm with a jaw of 2 kg beside its tip.
std::string make_arm_with_jaw() {
  std::string xml = read_file(resolve_config("robots", "irb4600_40_255"), 1 << 20);
  return xml.replace(xml.find("</robot>"), 8, R"(<joint name="jaw_joint" type="prismatic">
  <parent link="link_3"/><child link="jaw"/><origin xyz="0.135 0 0"/><axis xyz="0 1 0"/></joint>
  <link name="jaw"><inertial><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0"
  ixz="0" iyz="0"/></inertial></link></robot>)");
}

TEST(RobotTable, NamesTheTipOfAnArmWithBranches) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_arm_with_jaw());
  folder.write("p.toml", "extends = \"base\"\n[robot]\nurdf = 'arm.urdf'\ntip = 'tip'\n");
  const LoadedProblem loaded = folder.load("p.toml");
  const RobotModel& robot = loaded.tracking()->config().robot;
  EXPECT_EQ(robot.joint_count(), 4u);
  EXPECT_NEAR(robot.links[3].inertial.mass_kg, 13.8 + 2, 1e-14);
  EXPECT_THAT(loaded.resolved_json, HasSubstr("\"tip\":\"tip\""));
}

TEST(RobotTable, RefusalsNameFileAndKey) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_arm_with_jaw());
  const std::string arm = "[robot]\nurdf = 'arm.urdf'\n";
  EXPECT_EQ(folder.refusal_of_base_with(arm),
            "p.toml:3: robot.urdf is 'arm.urdf'; arm.urdf: the links branch and end in 'tip', "
            "'jaw'; name the one whose frame is the tool centre point (or any other link) with "
            "robot.tip or --tip");
  EXPECT_THAT(folder.refusal_of_base_with(arm + "tip = 'tp'"),
              StartsWith("p.toml:4: robot.tip is 'tp'; arm.urdf: unknown link 'tp'; did "
                         "you mean 'tip'? Valid: base, "));
  EXPECT_THAT(folder.refusal_of_base_with(arm + "tip = 'link_2'\nbase = 'link_3'"),
              StartsWith("p.toml:4: robot.tip is 'link_2'; arm.urdf: the tip 'link_2' is above the "
                         "base 'link_3' in the tree of links"));
  EXPECT_THAT(folder.refusal_of_base_with(arm + "tip = 'tip'\ndensity_kg_per_m3 = 0.5"),
              HasSubstr("p.toml:5: robot.density_kg_per_m3 is 0.5; it must be "));
  EXPECT_THAT(folder.refusal_of_base_with(arm + "tip = 4"),
              HasSubstr("p.toml:4: robot.tip is 4, an integer; it must be a string"));
  EXPECT_THAT(folder.refusal_of_base_with("[robot]\nurdf = 'arm.urdf.xacro'"),
              HasSubstr("there is no file 'arm.urdf.xacro'"));
}

// An arm of two links without masses. The foot's own mass is impossible.
constexpr const char* kMassless = R"(<robot name="arm">
<link name="foot"><inertial><mass value="1"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0"
  iyz="0"/></inertial></link>
<joint name="swing" type="revolute"><parent link="foot"/><child link="upper"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" velocity="3" effort="200"/></joint>
<link name="upper">%s</link>
<joint name="bend" type="revolute"><parent link="upper"/><child link="lower"/>
  <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" velocity="3" effort="80"/></joint>
<link name="lower">%s</link>
<joint name="end" type="fixed"><parent link="lower"/><child link="tool0"/><origin xyz="0 0 0.4"/></joint>
<link name="tool0"/>
<joint name="side" type="fixed"><parent link="lower"/><child link="camera"/></joint>
<link name="camera"/></robot>)";

std::string make_massless(const std::string& looks) {
  std::string xml = kMassless;
  for (int i = 0; i < 2; ++i) {
    xml.replace(xml.find("%s"), 2, looks);
  }
  return xml;
}

// The problem `robot` repairs. Its record says what was chosen and is read as the same robot.
TEST(RobotTable, RecordsWhatTheReaderOfTheRobotChose) {
  const std::string box = "<visual><geometry><box size=\"0.1 0.1 0.4\"/></geometry></visual>";
  const std::string mesh =
      "<visual><geometry><mesh filename=\"package://none/a.stl\"/></geometry></visual>";
  for (const auto& [looks, recorded, left_out] :
       {std::tuple(box, "\"density_kg_per_m3\":1000", "mass_from_shapes"),
        std::tuple(mesh, "\"mass_from_shapes\":false", "\"density_kg_per_m3\":1000")}) {
    const ProblemFolder folder;
    folder.write("arm.urdf", make_massless(looks));
    folder.write("p.toml", "extends = \"robot\"\n[robot]\nurdf = 'arm.urdf'\n");
    const LoadedProblem loaded = folder.load("p.toml");
    EXPECT_THAT(loaded.resolved_json, HasSubstr("\"repair\":true"));
    EXPECT_THAT(loaded.resolved_json, HasSubstr("\"tip\":\"tool0\""));
    EXPECT_THAT(loaded.resolved_json, HasSubstr(recorded));
    EXPECT_THAT(loaded.resolved_json, Not(HasSubstr(left_out)));
    EXPECT_THAT(loaded.resolved_json, Not(HasSubstr("packages")));
    const LoadedProblem again = load_recorded_problem(loaded.resolved_json, "arm", folder.path(""));
    EXPECT_EQ(again.resolved_json, loaded.resolved_json);
    const RobotModel& first = loaded.tracking()->config().robot;
    const RobotModel& second = again.tracking()->config().robot;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(first.links[i].inertial.mass_kg, second.links[i].inertial.mass_kg);
      EXPECT_GT(first.links[i].inertial.mass_kg, 0);
    }
  }
}

// Version 1.0 knew no repairs: a configuration without the key refuses what it refused.
TEST(RobotTable, RefusesArmsWithoutMassUnlessRepairIsSet) {
  const ProblemFolder folder;
  folder.write("arm.urdf", make_massless(""));
  const std::string text =
      "kind = \"tracking\"\n[robot]\nurdf = 'arm.urdf'\npropose = true\n"
      "tip = 'tool0'\n[variables]\nstart = \"proposed\"\n";
  folder.write("p.toml", text);
  EXPECT_THAT(
      folder.shorten(error_of(ErrorKind::bad_data, [&] { folder.load("p.toml"); })),
      StartsWith("arm.urdf: 2 things to mend\narm.urdf:4: joint 'swing' moves link 'upper', "
                 "which has no mass; "));
  folder.write("p.toml", text + "[task]\n");
  const std::vector<std::string> repair{"robot.repair=true"};
  EXPECT_GT(folder.load("p.toml", repair).tracking()->config().robot.links[0].inertial.mass_kg, 0);
  const ProblemFolder shipped;
  shipped.write("p.toml", "extends = \"base\"\n");
  EXPECT_THAT(shipped.load("p.toml").resolved_json, Not(HasSubstr("\"repair\"")))
      << "records of version 1.0 have no such key";
}

TEST(RobotTable, RecordsFoldersOfPackages) {
  const ProblemFolder folder;
  folder.write("p.toml", "extends = \"base\"\n[robot]\npackages = ['arm=meshes', 'b=/opt/b']\n");
  const LoadedProblem loaded = folder.load("p.toml");
  EXPECT_THAT(loaded.resolved_json,
              HasSubstr("\"packages\":[\"arm=" + folder.path("meshes") + "\",\"b=/opt/b\"]"));
  EXPECT_EQ(loaded.tracking()->config().robot.reading.packages.at("arm"), folder.path("meshes"));
  EXPECT_THAT(folder.refusal_of_base_with("[robot]\npackages = ['arm']"),
              HasSubstr("p.toml:3: robot.packages is ['arm']; each must be NAME=DIR"));
}

// A mesh that masses come from is as much an input as the URDF.
TEST(RobotTable, HashesTheMeshesThatMassesComeFrom) {
  if (!can_read_meshes()) {
    GTEST_SKIP() << "built without Assimp";
  }
  const ProblemFolder folder;
  std::string xml = make_arm_with_jaw();
  const std::size_t at = xml.find("<inertial>", xml.find("<link name=\"jaw\">"));
  xml.replace(at, xml.find("</inertial>", at) + 11 - at,
              "<visual><geometry><mesh filename=\"wedge.obj\"/></geometry></visual>");
  folder.write("arm.urdf", xml);
  const std::string wedge =
      "v 0 0 0\nv 0.3 0 0\nv 0 0.2 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  folder.write("wedge.obj", wedge);
  folder.write("p.toml",
               "extends = \"base\"\n[robot]\nurdf = 'arm.urdf'\ntip = 'tip'\n"
               "density_kg_per_m3 = 2700\n");
  const LoadedProblem loaded = folder.load("p.toml");
  // A corner of a box: a sixth of it. The mesh has numbers of 32 bits.
  EXPECT_NEAR(loaded.tracking()->config().robot.links[3].inertial.mass_kg,
              13.8 + 2700 * 0.3 * 0.2 * 0.1 / 6, 1e-6);
  EXPECT_THAT(loaded.input_hashes,
              UnorderedElementsAre(Key("arm.urdf"), Key("table-a1.toml"), Key("wedge.obj")));
  EXPECT_EQ(loaded.input_hashes.at("wedge.obj"), calc_sha256_hex(wedge));
}

}  // namespace
}  // namespace armwright
