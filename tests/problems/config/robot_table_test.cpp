// [robot] of a problem: which part of a URDF it simulates.
#include <gmock/gmock.h>

#include "base/file.hpp"
#include "base/hash.hpp"
#include "problems/config/config_files.hpp"
#include "problems/problem_folder.hpp"
#include "sim/robot/mesh_file.hpp"

namespace armwright {
namespace {

using ::testing::HasSubstr;
using ::testing::Key;
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
              StartsWith("p.toml:5: robot.base is 'link_3'; arm.urdf: the base 'link_3' is not "
                         "above the tip 'link_2'"));
  EXPECT_THAT(folder.refusal_of_base_with(arm + "tip = 'tip'\ndensity_kg_per_m3 = 0.5"),
              HasSubstr("p.toml:5: robot.density_kg_per_m3 is 0.5; it must be "));
  EXPECT_THAT(folder.refusal_of_base_with(arm + "tip = 4"),
              HasSubstr("p.toml:4: robot.tip is 4, an integer; it must be a string"));
  EXPECT_THAT(folder.refusal_of_base_with("[robot]\nurdf = 'arm.urdf.xacro'"),
              HasSubstr("there is no file 'arm.urdf.xacro'"));
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
