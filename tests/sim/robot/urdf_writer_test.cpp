#include "sim/robot/urdf_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "base/error.hpp"
#include "base/file.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string read_arm(const std::string& name) {
  return read_file(std::string(ARMWRIGHT_TEST_DATA) + "/urdf/" + name, 1 << 20);
}

// Returns a robot with that joint; the joint's child is the only moving link.
std::string make_urdf(const std::string& joint) {
  return "<robot name=\"r\"><link name=\"base\"/>" + joint +
         "<link name=\"l\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" "
         "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link></robot>";
}
constexpr const char* kEnds = "<parent link=\"base\"/><child link=\"l\"/>";

// Returns the text after the comment at the beginning.
std::string cut_comment(const std::string& text) {
  const std::string end = "-->\n";
  return text.substr(text.find(end) + end.size());
}

TEST(SetEffortLimits, ChangesTheseValuesAndNoOtherByte) {
  const std::string xml = read_arm("rail_and_pole.urdf");
  const std::map<std::string, double> efforts = {{"pivot", 12.5}, {"rail", 1.0 / 3}};
  const std::string changed = set_effort_limits(xml, "r.urdf", efforts, "by us");
  std::string expected = xml;
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(expected.find(from), std::string::npos);
    expected.replace(expected.find(from), from.size(), to);
  };
  replace("effort=\"300\"", "effort=\"0.3333333333333333\"");
  replace("<axis xyz=\"1 0 0\"/>\n  </joint>",
          "<axis xyz=\"1 0 0\"/>\n    <limit effort=\"12.5\" velocity=\"1000000\"/>\n  </joint>");
  replace("<?xml version=\"1.0\"?>\n", "<?xml version=\"1.0\"?>\n<!--\nby us\n-->\n");
  EXPECT_EQ(changed, expected);
}

TEST(SetEffortLimits, IsTheSameRobotToOurReaderButForTheLimits) {
  const std::string xml = read_arm("rail_and_pole.urdf");
  const std::map<std::string, double> efforts = {{"rail", 7}, {"pivot", 9}};
  RobotModel before = parse_urdf(xml, "before");
  const RobotModel after = parse_urdf(set_effort_limits(xml, "r", efforts, ""), "after");
  ASSERT_EQ(after.joint_count(), before.joint_count());
  EXPECT_EQ(after.joints[0].effort_limit, 7);
  EXPECT_EQ(after.joints[1].effort_limit, 9);
  EXPECT_EQ(after.joints[1].speed_limit, kNoVelocityLimit_rad_per_s);
  for (std::size_t i = 0; i < before.joint_count(); ++i) {
    const Joint& a = before.joints[i];
    const Joint& b = after.joints[i];
    EXPECT_EQ(b.name, a.name);
    EXPECT_EQ(b.kind, a.kind);
    EXPECT_EQ(b.origin.matrix(), a.origin.matrix());
    EXPECT_EQ(b.axis, a.axis);
    EXPECT_EQ(b.lower, a.lower);
    EXPECT_EQ(b.upper, a.upper);
    EXPECT_EQ(after.links[i].inertial.mass_kg, before.links[i].inertial.mass_kg);
    EXPECT_EQ(after.links[i].inertial.inertia_kg_m2, before.links[i].inertial.inertia_kg_m2);
  }
}

TEST(SetEffortLimits, FindsJointsBehindEntitiesQuotesAndLookalikes) {
  const std::string xml = make_urdf(
      "<!-- <joint name='a&b'><limit effort='1'/></joint> -->"
      "<transmission name='t'><joint name='a&amp;&#x62;'><limit effort='2'/></joint></transmission>"
      "<joint\n type = \"revolute\"\tname = 'a&amp;&#x62;' >" +
      std::string(kEnds) +
      "<limit lower='-1' note='a > effort=\"3\"' effort = '4'\n upper='1' velocity='5' />"
      "<safety_controller k_velocity='1'/></joint>"
      "<gazebo><joint name='a&b;'/></gazebo>");
  // '&b;' is not a defined entity, so the text is invalid.
  const std::map<std::string, double> efforts = {{"a&b", 6}};
  EXPECT_THROW(set_effort_limits(xml, "r", efforts, ""), Error);
  std::string valid = xml;
  valid.replace(valid.find("<gazebo>"), std::string("<gazebo><joint name='a&b;'/></gazebo>").size(),
                "");
  // A comment may contain any text.
  const std::string changed = cut_comment(set_effort_limits(valid, "r", efforts, ""));
  std::string expected = valid;
  expected.replace(expected.find("effort = '4'"), 12, "effort = '6'");
  EXPECT_EQ(changed, expected);
  EXPECT_EQ(parse_urdf(changed, "r").joints[0].effort_limit, 6);
}

TEST(SetEffortLimits, TakesTheJointOfThatNameInAnyScript) {
  const std::string xml = make_urdf("<joint name='&#252;&#x4E2D;&#128512;' type='continuous'>" +
                                    std::string(kEnds) + "</joint>");
  const std::map<std::string, double> efforts = {{"ü中😀", 2}};
  const std::string changed = set_effort_limits(xml, "r", efforts, "");
  EXPECT_THAT(changed,
              HasSubstr("<child link=\"l\"/><limit effort=\"2\" velocity=\"1000000\"/></joint>"));
  EXPECT_EQ(parse_urdf(changed, "r").joints[0].effort_limit, 2);
}

TEST(SetEffortLimits, KeepsLineEndsAndWhatMustComeFirst) {
  std::string xml = read_arm("rail_and_pole.urdf");
  for (std::size_t at = 0; (at = xml.find('\n', at)) != std::string::npos; at += 2) {
    xml.replace(at, 1, "\r\n");
  }
  const std::map<std::string, double> efforts = {{"pivot", 1}};
  const std::string changed = set_effort_limits("\xef\xbb\xbf" + xml, "r", efforts, "us");
  EXPECT_THAT(changed, StartsWith("\xef\xbb\xbf<?xml version=\"1.0\"?>\r\n<!--\nus\n-->\n<robot"));
  EXPECT_THAT(changed,
              HasSubstr("\r\n    <limit effort=\"1\" velocity=\"1000000\"/>\r\n  </joint>"));
  EXPECT_EQ(parse_urdf(changed, "r").joints[1].effort_limit, 1);
}

TEST(SetEffortLimits, NothingInItsCommentEndsIt) {
  const std::string xml = read_arm("two_joints.urdf");
  const std::string changed = set_effort_limits(xml, "r", {}, "--> <x/> ---- a--b -");
  const std::string comment = changed.substr(0, changed.find("-->"));
  EXPECT_EQ(comment.find("--", comment.find("<!--") + 4), std::string::npos) << comment;
  EXPECT_EQ(parse_urdf(changed, "r").joint_count(), 2u);
}

TEST(SetEffortLimits, RefusesAJointThatIsNotThere) {
  const std::map<std::string, double> efforts = {{"nowhere", 1}};
  try {
    set_effort_limits(read_arm("two_joints.urdf"), "r.urdf", efforts, "");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    EXPECT_THAT(error.what(), HasSubstr("r.urdf:1: has no joint 'nowhere'"));
  }
}

}  // namespace
}  // namespace armwright
