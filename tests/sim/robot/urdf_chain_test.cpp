// Tests which joints of a URDF move and how the others are treated. The file resembles those that
// xacro makes for a real cell, with a lift, cables, jaws and data for other programs.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::filesystem::path kCell = std::filesystem::path(ARMWRIGHT_TEST_DATA) / "urdf/cell.urdf";

std::string cell_xml() {
  return read_file(kCell, 1 << 20);
}

// Returns `text` with the first `from` replaced by `to`.
std::string replace_first(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

RobotModel load_cell(const std::string& base = "base_link", const std::string& tip = "tool0") {
  return load_urdf(kCell, {.base = base, .tip = tip});
}

Eigen::Isometry3d make_pose(double x, double y, double z, double angle,
                            const Eigen::Vector3d& axis) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << x, y, z;
  pose.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return pose;
}

TEST(UrdfChain, RunsFromTheBaseToTheTip) {
  const RobotModel cell = load_cell();
  ASSERT_EQ(cell.joint_count(), 2u);
  EXPECT_EQ(cell.joints[0].name, "turn");
  EXPECT_EQ(cell.joints[1].name, "bend");
  EXPECT_EQ(cell.links[0].name, "upper_arm");
  EXPECT_EQ(cell.links[1].name, "hand");
  EXPECT_EQ(cell.base.name, "world");
  // The world stays the root: the mount's tilt and the lift, 0.2 m up along its axis, are the
  // origin's. Tolerance: a few roundings of numbers of size 1.
  const Eigen::Isometry3d origin = make_pose(0, 0, 1.5, 0.5, Eigen::Vector3d::UnitY()) *
                                   make_pose(0, 0, 0.2 + 0.2, 0.3, Eigen::Vector3d::UnitZ());
  EXPECT_LT((cell.joints[0].origin.matrix() - origin.matrix()).norm(), 1e-14);
  EXPECT_EQ(cell.joints[1].origin.translation(), Eigen::Vector3d(0.4, 0, 0));
  EXPECT_EQ(cell.tip_pose.translation(), Eigen::Vector3d(0, 0, 0.25));
  EXPECT_EQ(cell.base.visuals.size(), 1u) << "the mesh of base_link";
  EXPECT_EQ(cell.base.inertial.mass_kg, 0.5) << "the beacon";
}

TEST(UrdfChain, TakesLimitsOfZeroForNone) {
  const RobotModel cell = load_cell();
  EXPECT_EQ(cell.joints[0].speed_limit, kInfinity);
  EXPECT_EQ(cell.joints[0].effort_limit, kInfinity);
  EXPECT_EQ(cell.joints[0].lower, -2.5);
  EXPECT_EQ(cell.joints[1].speed_limit, 3);
  EXPECT_EQ(cell.joints[1].effort_limit, 30);
}

// A held joint equals a fixed joint at the same position; a turn of 0.4 rad about y is the pitch of
// <origin>. Tolerance: angles pass through quaternions, a few roundings of numbers below 1.
TEST(UrdfChain, HoldsJointsWhereAFixedOneWouldBe) {
  std::string xml = cell_xml();
  xml = replace_first(xml, "name=\"cable_joint\" type=\"revolute\"",
                      "name=\"cable_joint\" type=\"fixed\"");
  xml = replace_first(xml,
                      "<child link=\"cable\"/>\n    <origin xyz=\"0.3 0 0.05\" rpy=\"0.1 0 0\"/>",
                      "<child link=\"turned\"/>\n    <origin xyz=\"0.3 0 0.05\" rpy=\"0.1 0 0\"/>");
  xml = replace_first(xml, "<link name=\"cable\">",
                      "<link name=\"turned\"/><joint name=\"at_its_end\" type=\"fixed\"><parent "
                      "link=\"turned\"/><child link=\"cable\"/><origin rpy=\"0 0.4 0\"/></joint>"
                      "<link name=\"cable\">");
  for (const std::string jaw : {"left", "right"}) {
    xml = replace_first(xml, "name=\"" + jaw + "_jaw_joint\" type=\"prismatic\"",
                        "name=\"" + jaw + "_jaw_joint\" type=\"fixed\"");
  }
  const RobotModel fixed = parse_urdf(xml, "fixed.urdf", {.base = "base_link", .tip = "tool0"});
  const RobotModel held = load_cell();
  for (std::size_t i = 0; i < 2; ++i) {
    const Inertial& a = held.links[i].inertial;
    const Inertial& b = fixed.links[i].inertial;
    EXPECT_NEAR(a.mass_kg, b.mass_kg, 1e-15);
    EXPECT_LT((a.com_m - b.com_m).norm(), 1e-15);
    EXPECT_LT((a.inertia_kg_m2 - b.inertia_kg_m2).norm(), 1e-15);
  }
  // And by hand: the jaws, 0.2 kg each, 0.23 m up beside the hand's 1.2 kg at 0.1 m.
  const Inertial& hand = held.links[1].inertial;
  EXPECT_DOUBLE_EQ(hand.mass_kg, 1.6);
  EXPECT_NEAR(hand.com_m.z(), (1.2 * 0.1 + 0.4 * 0.23) / 1.6, 1e-15);
  EXPECT_NEAR(hand.com_m.y(), 0, 1e-15);
  const double com = hand.com_m.z();
  EXPECT_NEAR(hand.inertia_kg_m2(2, 2), 0.002 + 2 * 1e-4 + 0.4 * 0.02 * 0.02, 1e-15);
  EXPECT_NEAR(hand.inertia_kg_m2(1, 1),
              0.004 + 2 * 1e-4 + 1.2 * std::pow(0.1 - com, 2) + 0.4 * std::pow(0.23 - com, 2),
              1e-15);
}

TEST(UrdfChain, NotesSayWhatWasDone) {
  EXPECT_THAT(
      load_cell().notes,
      ElementsAre(
          "<inertial> with zeros is taken for none: 'tool0'",
          "joints are simulated without the <dynamics> of 'turn' (damping 0.5, friction 0.25), "
          "'bend' (damping 0.1); robot.dynamics = true gives them this friction",
          "<limit effort=\"0\"> is taken for no limit: 'turn'",
          "<limit velocity=\"0\"> is taken for no limit: 'turn'",
          "the soft limits of <safety_controller> are left out: 'turn'",
          "joint 'lift' is not between 'base_link' and 'tool0': held at 0.2 m, what hangs on it "
          "is part of the fixed base",
          "joint 'beacon_joint' is not between 'base_link' and 'tool0': held at its origin, its "
          "0.5 kg are part of the fixed base",
          "joint 'cable_joint' is not between 'base_link' and 'tool0': held at 0.4 rad, its 0.3 kg "
          "are part of link 'upper_arm'",
          "joint 'left_jaw_joint' is not between 'base_link' and 'tool0': held at 0 m, its 0.2 kg "
          "are part of link 'hand'",
          "joint 'right_jaw_joint' is not between 'base_link' and 'tool0': held at 0 m, its 0.2 kg "
          "are part of link 'hand'"));
  EXPECT_THAT(load_urdf(kCell.parent_path() / "two_joints.urdf").notes, IsEmpty());
}

TEST(UrdfChain, TheLiftMovesWhereTheChainBeginsAboveIt) {
  const RobotModel cell = load_cell("", "tool0");
  ASSERT_EQ(cell.joint_count(), 3u);
  EXPECT_EQ(cell.joints[0].name, "lift");
  EXPECT_EQ(cell.joints[0].lower, 0.2);
  EXPECT_EQ(cell.links[0].inertial.mass_kg, 0.5) << "the beacon rides on it";
}

// The tip need not be a leaf. All links beyond it become part of its link, also those on movable
// joints.
TEST(UrdfChain, WhatHangsBeyondTheTipIsPartOfIt) {
  const RobotModel cell = load_cell("mount", "upper_arm");
  ASSERT_EQ(cell.joint_count(), 2u);
  EXPECT_TRUE(cell.tip_pose.isApprox(Eigen::Isometry3d::Identity(), 0));
  EXPECT_NEAR(cell.links[1].inertial.mass_kg, 3 + 0.3 + 1.2 + 2 * 0.2, 1e-15);
  EXPECT_EQ(cell.links[1].visuals.size(), 2u);
  EXPECT_THAT(cell.notes, testing::Contains(StartsWith("joint 'bend' is not between 'mount' and "
                                                       "'upper_arm': held at 0 rad, its 1.2 kg")));
}

// In two_joints.urdf, whose only leaf is the tool.
TEST(UrdfChain, DefaultsAreTheRootAndTheOnlyLeaf) {
  const std::filesystem::path file = kCell.parent_path() / "two_joints.urdf";
  const RobotModel whole = load_urdf(file);
  const RobotModel named = load_urdf(file, {.base = "world", .tip = "tool"});
  const RobotModel upper = load_urdf(file, {.base = "arm"});
  EXPECT_EQ(whole.joint_count(), named.joint_count());
  EXPECT_EQ(whole.tip_pose.matrix(), named.tip_pose.matrix());
  ASSERT_EQ(upper.joint_count(), 1u);
  EXPECT_EQ(upper.joints[0].name, "second");
  EXPECT_EQ(upper.base.inertial.mass_kg, 7 + 1.5);
  // The first joint stays at 0: the second one's place in the world is that of the whole arm's.
  const Eigen::Isometry3d expected = whole.joints[0].origin * whole.joints[1].origin;
  EXPECT_LT((upper.joints[0].origin.matrix() - expected.matrix()).norm(), 1e-15);
}

struct OptionTrap {
  std::string name;
  RobotOptions options;
  std::string option;  // that the error names
  std::string message;
};
void PrintTo(const OptionTrap& trap, std::ostream* out) {
  *out << trap.name;
}

class UrdfOptionTrap : public ::testing::TestWithParam<OptionTrap> {};

TEST_P(UrdfOptionTrap, IsRefusedWithTheOptionAndTheReason) {
  const OptionTrap& trap = GetParam();
  try {
    parse_urdf(cell_xml(), "cell.urdf", trap.options);
    FAIL();
  } catch (const RobotOptionError& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(error.option(), trap.option);
    EXPECT_EQ(std::string(error.what()), "cell.urdf: " + trap.message);
  }
}

const std::string kLinks =
    "world, mount, base_link, beacon, upper_arm, cable, hand, left_jaw, right_jaw, tool0";

INSTANTIATE_TEST_SUITE_P(
    Options, UrdfOptionTrap,
    ::testing::Values(
        OptionTrap{"tip_unknown",
                   {.tip = "tool"},
                   "tip",
                   "unknown link 'tool'; did you mean 'tool0'? Valid: " + kLinks},
        OptionTrap{"base_unknown",
                   {.base = "flange\x1b", .tip = "tool0"},
                   "base",
                   "unknown link 'flange?'. Valid: " + kLinks},
        OptionTrap{"base_below_tip",
                   {.base = "hand", .tip = "upper_arm"},
                   "tip",
                   "the tip 'upper_arm' is above the base 'hand' in the tree of links, and a chain "
                   "runs down from its base to its tip; exchange them (--base upper_arm --tip "
                   "hand), or name a tip below the base"},
        OptionTrap{"base_beside_tip",
                   {.base = "cable", .tip = "hand"},
                   "base",
                   "the base 'cable' is not above the tip 'hand', and the path from the root to "
                   "the tip is "
                   "'world' -> 'mount' -> 'base_link' -> 'upper_arm' -> 'hand'; name one of these"},
        OptionTrap{"nothing_moves",
                   {.base = "hand", .tip = "tool0"},
                   "tip",
                   "no joint between the base 'hand' and the tip 'tool0' moves; the chain needs at "
                   "least one revolute, continuous or prismatic joint"},
        OptionTrap{"same_link",
                   {.base = "hand", .tip = "hand"},
                   "tip",
                   "no joint between the base 'hand' and the tip 'hand' moves; the chain needs at "
                   "least one revolute, continuous or prismatic joint"},
        OptionTrap{"density",
                   {.tip = "tool0", .density_kg_per_m3 = -1},
                   "density_kg_per_m3",
                   "the density is -1 kg/m3; it must be finite and > 0, or 0 for none"}),
    [](const auto& trap) { return trap.param.name; });

// The leaves below each base, the frame of the tool among them has no tool's name.
TEST(UrdfChain, NamesTheLeavesToChooseFromWhereNoneIsClearlyTheTool) {
  std::string xml = cell_xml();
  for (std::size_t at = xml.find("tool0"); at != std::string::npos; at = xml.find("tool0")) {
    xml.replace(at, 5, "plate");
  }
  const auto refusal_of = [&](const std::string& base) {
    try {
      parse_urdf(xml, "cell.urdf", {.base = base});
    } catch (const RobotOptionError& error) {
      EXPECT_EQ(error.option(), "tip");
      return std::pair(std::string(error.what()), error.leaves());
    }
    return std::pair(std::string("no error"), std::vector<std::string>());
  };
  const auto [message, leaves] = refusal_of("");
  EXPECT_EQ(message,
            "cell.urdf: the links branch and end in 'beacon', 'cable', 'left_jaw', 'right_jaw', "
            "'plate'; name the one whose frame is the tool centre point (or any other link) with "
            "robot.tip or --tip");
  EXPECT_THAT(leaves, ElementsAre("beacon", "cable", "left_jaw", "right_jaw", "plate"));
  EXPECT_THAT(refusal_of("hand").second, ElementsAre("left_jaw", "right_jaw", "plate"));
}

TEST(UrdfChain, TakesTheOnlyLeafWithAToolsName) {
  const RobotModel cell = load_cell("base_link", "");
  EXPECT_EQ(cell.reading.tip, "tool0");
  EXPECT_TRUE(cell.reading.is_tip_proposed);
  EXPECT_EQ(cell.joint_count(), 2u);
  EXPECT_THAT(cell.notes,
              testing::Contains("the tip is taken to be 'tool0'; the other ends are 'beacon', "
                                "'cable', 'left_jaw', 'right_jaw'; robot.tip or --tip names "
                                "another"));
  EXPECT_FALSE(load_cell().reading.is_tip_proposed) << "it was named";
}

// One joint turns a link; further links are on fixed joints. Each has the name of its parent.
std::string make_tree(const std::vector<std::pair<std::string, std::string>>& fixed,
                      const std::string& looks = "") {
  std::string xml =
      "<robot name=\"tree\"><link name=\"base_link\"/>"
      "<joint name=\"turn\" type=\"continuous\"><parent link=\"base_link\"/>"
      "<child link=\"arm\"/></joint><link name=\"arm\"><inertial><mass value=\"1\"/>"
      "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
  for (const auto& [parent, child] : fixed) {
    xml += "<link name=\"" + child + "\">" + looks + "</link><joint name=\"to_" + child +
           "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" + child +
           "\"/></joint>";
  }
  return xml + "</robot>";
}

std::string propose_tip(const std::string& xml) {
  try {
    return parse_urdf(xml, "tree.urdf").reading.tip;
  } catch (const RobotOptionError& error) {
    return error.option() + " is missing";
  }
}

TEST(UrdfChain, TakesNoLeafForTheTipThatDoesNotMove) {
  EXPECT_EQ(propose_tip(make_tree({{"base_link", "base"}, {"arm", "plate"}})), "plate");
  EXPECT_EQ(propose_tip(make_tree({{"base_link", "tool0"}, {"arm", "plate"}})), "plate");
  EXPECT_EQ(propose_tip(make_tree({{"arm", "camera"}, {"arm", "plate"}})), "tip is missing");
}

TEST(UrdfChain, TakesNoCollisionHelperForTheTip) {
  EXPECT_EQ(propose_tip(make_tree({{"arm", "arm_sc"}, {"arm", "plate"}})), "plate");
  EXPECT_EQ(propose_tip(make_tree({{"arm", "arm_collision"}, {"arm", "plate"}})), "plate");
  const std::string seen = "<visual><geometry><sphere radius=\"0.1\"/></geometry></visual>";
  EXPECT_EQ(propose_tip(make_tree({{"arm", "arm_sc"}, {"arm", "plate"}}, seen)), "tip is missing")
      << "a part that can be seen is no helper";
}

TEST(UrdfChain, KnowsTheNamesOfToolFrames) {
  for (const std::string name : {"tool0", "my_tcp", "ee_link", "flange", "hand-TCP", "arm_ee",
                                 "end_effector", "tool_frame", "left_eef"}) {
    EXPECT_EQ(propose_tip(make_tree({{"arm", "camera"}, {"arm", name}})), name);
  }
  for (const std::string name : {"knee", "toolbox", "flanger", "tool0_camera"}) {
    EXPECT_EQ(propose_tip(make_tree({{"arm", "camera"}, {"arm", name}})), "tip is missing") << name;
  }
  EXPECT_EQ(propose_tip(make_tree({{"arm", "left_tcp"}, {"arm", "right_tcp"}})), "tip is missing")
      << "two tools";
}

// Each case changes one place of the file; the chain runs from base_link to the given tip.
struct CellTrap {
  std::string name;
  std::string from, to;
  std::string tip;
  std::string message;  // "no error": none
};
void PrintTo(const CellTrap& trap, std::ostream* out) {
  *out << trap.name;
}

class UrdfCellTrap : public ::testing::TestWithParam<CellTrap> {};

TEST_P(UrdfCellTrap, IsRefusedWithLineAndReason) {
  const CellTrap& trap = GetParam();
  std::string message = "no error";
  try {
    parse_urdf(replace_first(cell_xml(), trap.from, trap.to), "cell.urdf",
               {.base = "base_link", .tip = trap.tip});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    message = error.what();
  }
  EXPECT_THAT(message, StartsWith(trap.message));
}

const std::string kCableLimit = "<limit lower=\"0.4\" upper=\"1.2\" velocity=\"1\" effort=\"1\"/>";

INSTANTIATE_TEST_SUITE_P(
    Cell, UrdfCellTrap,
    ::testing::Values(
        CellTrap{"xacro_element", "<link name=\"world\"/>", "<xacro:world name=\"world\"/>",
                 "tool0",
                 "cell.urdf:9: the file: <xacro:world> is an element of xacro; xacro is not read: "
                 "expand the file and give armwright the result."},
        CellTrap{"xacro_name", "<link name=\"mount\"/>", "<link name=\"${prefix}mount\"/>", "tool0",
                 "cell.urdf:15: a link: <link>: name is '${prefix}mount', an expression of xacro; "
                 "xacro is not read"},
        CellTrap{"xacro_mesh", "package://cell_support/meshes/base_link.stl",
                 "$(find cell_support)/meshes/base_link.stl", "tool0",
                 "cell.urdf:24: link 'base_link': <mesh>: filename is '$(find cell_support)/meshes/"
                 "base_link.stl', an expression of xacro"},
        CellTrap{
            "mimic_on_the_chain", "", "", "right_jaw",
            "cell.urdf:111: joint 'right_jaw_joint': follows another joint (<mimic>), which is "
            "not simulated between base 'base_link' and tip 'right_jaw'; name a tip above it "
            "(robot.tip or --tip), remove the element, or make the joint fixed"},
        CellTrap{"floating_on_the_chain", "", "", "beacon",
                 "cell.urdf:30: joint 'beacon_joint': the type is 'floating'; between base "
                 "'base_link' and tip 'beacon' only revolute, continuous, prismatic and fixed "
                 "joints are simulated"},
        CellTrap{"planar_beside_the_chain", "type=\"floating\"", "type=\"planar\"", "tool0",
                 "no error"},
        CellTrap{"joint_of_no_type", "type=\"floating\"", "type=\"ball\"", "tool0",
                 "cell.urdf:30: joint 'beacon_joint': unknown type 'ball'. Valid: revolute, "
                 "continuous, prismatic, fixed, floating, planar"},
        CellTrap{"held_without_limit", kCableLimit, "", "tool0", "no error"},
        CellTrap{"held_without_effort", kCableLimit, "<limit lower=\"0.4\" upper=\"1.2\"/>",
                 "tool0", "no error"},
        CellTrap{"held_the_wrong_way_round", kCableLimit, "<limit lower=\"2\" upper=\"1\"/>",
                 "tool0",
                 "cell.urdf:66: joint 'cable_joint': <limit>: lower is 2 and upper is 1 rad; lower "
                 "must be <= upper"},
        CellTrap{"held_without_a_number", kCableLimit, "<limit lower=\"a\" upper=\"1\"/>", "tool0",
                 "cell.urdf:66: joint 'cable_joint': <limit>: lower is 'a'; it must be one finite "
                 "number"},
        CellTrap{"held_without_direction", "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>",
                 "tool0",
                 "cell.urdf:19: joint 'lift': <axis>: xyz is '0 0 0', which has no direction"},
        CellTrap{"damping_of_no_size", "damping=\"0.5\"", "damping=\"-0.5\"", "tool0",
                 "cell.urdf:44: joint 'turn': <dynamics>: damping is -0.5; it must be >= 0"},
        CellTrap{"no_mass_but_inertia", "<mass value=\"0\"/><inertia ixx=\"0\"",
                 "<mass value=\"0\"/><inertia ixx=\"1\"", "tool0",
                 "cell.urdf:126: link 'tool0': <mass>: value is 0; it must be > 0 (a frame without "
                 "mass has an inertia of zeros, or no <inertial>)"},
        CellTrap{"moves_nothing",
                 "<mass value=\"1.2\"/>\n      <inertia ixx=\"0.004\" iyy=\"0.004\" izz=\"0.002\"",
                 "<mass value=\"0\"/>\n      <inertia ixx=\"0\" iyy=\"0\" izz=\"0\"", "tool0",
                 "no error"}),  // the jaws have mass
    [](const auto& trap) { return trap.param.name; });

TEST(UrdfFile, RefusesXacroByItsName) {
  try {
    load_urdf("robots/my.urdf.xacro");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    EXPECT_THAT(error.what(), StartsWith("robots/my.urdf.xacro: xacro is not read: expand "));
  }
}

}  // namespace
}  // namespace armwright
