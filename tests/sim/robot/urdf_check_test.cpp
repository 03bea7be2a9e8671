// Tests the errors in a URDF and their messages. Every case changes one place of a valid file.
#include <gmock/gmock.h>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::filesystem::path kValidFile =
    std::filesystem::path(ARMWRIGHT_TEST_DATA) / "urdf/two_joints.urdf";

std::string valid_xml() {
  return read_file(kValidFile, 1 << 20);
}

// Returns `text` with the only place where `from` stands replaced by `to`.
std::string replace(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << from << " stands twice";
  return text.replace(at, from.size(), to);
}

std::string message_of(const std::string& xml) {
  try {
    parse_urdf(xml, "robot.urdf");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    return error.what();
  }
  return "no error";
}

struct Trap {
  std::string name;
  std::string from, to;
  int line;             // 1-based, of the offending element
  std::string message;  // part of what follows "robot.urdf:LINE: "
};
void PrintTo(const Trap& trap, std::ostream* out) {
  *out << trap.name;
}

std::string name_of(const ::testing::TestParamInfo<Trap>& trap) {
  return trap.param.name;
}

class UrdfTrap : public ::testing::TestWithParam<Trap> {};

TEST_P(UrdfTrap, IsRefusedWithFileLineAndReason) {
  const Trap& trap = GetParam();
  const std::string message = message_of(replace(valid_xml(), trap.from, trap.to));
  EXPECT_THAT(message, StartsWith("robot.urdf:" + std::to_string(trap.line) + ": "));
  EXPECT_THAT(message, HasSubstr(trap.message));
}

const std::string kMass = "<mass value=\"1.5\"/>";
const std::string kInertia =
    "<inertia ixx=\"0.04\" iyy=\"0.05\" izz=\"0.06\" ixy=\"0.001\" ixz=\"0.002\" iyz=\"0.003\"/>";
const std::string kLimit = "<limit lower=\"-1\" upper=\"2\" velocity=\"3\" effort=\"40\"/>";

const std::string kHandInertial =
    "    <inertial>\n      <mass value=\"0.5\"/>\n      <inertia ixx=\"0.004\" iyy=\"0.005\" "
    "izz=\"0.006\" ixy=\"0\" ixz=\"0\" "
    "iyz=\"0\"/>\n    </inertial>\n";

Trap mass(const std::string& name, const std::string& value) {
  return {"mass_" + name, kMass, "<mass value=\"" + value + "\"/>", 26,
          "link 'arm': <mass>: value is '" + value + "'; it must be one finite number"};
}
Trap inertia(const std::string& name, const std::string& entries, const std::string& message) {
  return {"inertia_" + name, kInertia, "<inertia " + entries + "/>", 27,
          "link 'arm': <inertia>" + message};
}
Trap limit(const std::string& name, const std::string& attributes, const std::string& message) {
  return {"limit_" + name, kLimit, "<limit " + attributes + "/>", 21,
          "joint 'first': <limit>" + message};
}
// The first joint slides instead of turning.
Trap slide(const std::string& name, const std::string& attributes, const std::string& message) {
  const std::string rest =
      ">\n    <parent link=\"base\"/>\n    <child link=\"arm\"/>\n"
      "    <origin xyz=\"0.1 0.2 0.3\" rpy=\"0.1 0.2 0.3\"/>\n    <axis xyz=\"0 0 2\"/>\n    ";
  const std::string limit = attributes.empty() ? "" : "<limit " + attributes + "/>";
  return {"slide_" + name, "type=\"revolute\"" + rest + kLimit, "type=\"prismatic\"" + rest + limit,
          attributes.empty() ? 16 : 21, "joint 'first': " + message};
}
Trap type(const std::string& type_name) {
  return {"type_" + type_name, "type=\"continuous\"", "type=\"" + type_name + "\"", 34,
          "joint 'second': the type is '" + type_name +
              "'; between base 'world' and tip 'tool' only revolute, continuous, prismatic and "
              "fixed joints are simulated: name a base below it (robot.base or --base)"};
}

INSTANTIATE_TEST_SUITE_P(
    Numbers, UrdfTrap,
    ::testing::Values(
        mass("nan", "nan"), mass("inf", "inf"), mass("overflow", "1e999"), mass("unit", "1.5kg"),
        mass("comma", "1,5"), mass("hexadecimal", "0x10"), mass("two_numbers", "1 2"),
        mass("blank", " "), mass("beyond_reason", "1e300"),
        Trap{"mass_empty", kMass, "<mass value=\"\"/>", 26,
             "value is ''; it must be one finite number"},
        Trap{"mass_negative", kMass, "<mass value=\"-1\"/>", 26,
             "link 'arm': <mass>: value is -1; it must be > 0"},
        Trap{"mass_zero", kMass, "<mass value=\"0\"/>", 26, "value is 0; it must be > 0"},
        Trap{"mass_without_value", kMass, "<mass/>", 26, "<mass> has no value; it must have one"},
        Trap{"origin_nan", "<origin xyz=\"0.3 0 0\"/>", "<origin xyz=\"0.3 nan 0\"/>", 25,
             "link 'arm': <origin>: xyz is '0.3 nan 0'; it must be 3 finite numbers"},
        Trap{"origin_two_numbers", "<origin xyz=\"0.3 0 0\"/>", "<origin xyz=\"0.3 0\"/>", 25,
             "xyz is '0.3 0'; it must be 3 finite numbers"},
        Trap{"origin_four_numbers", "<origin xyz=\"0.3 0 0\"/>", "<origin xyz=\"0.3 0 0 0\"/>", 25,
             "xyz is '0.3 0 0 0'; it must be 3 finite numbers"},
        Trap{"rpy", "rpy=\"0.1 0.2 0.3\"", "rpy=\"0.1 0.2 90deg\"", 19,
             "joint 'first': <origin>: rpy is '0.1 0.2 90deg'; it must be 3 finite numbers"},
        Trap{"quaternion", "rpy=\"0.1 0.2 0.3\"", "quat_xyzw=\"0 0 0 1\"", 19,
             "quat_xyzw is not supported; give the rotation as rpy"},
        Trap{"axis_zero", "<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0 0\"/>", 20,
             "joint 'first': <axis>: xyz is '0 0 0', which has no direction; give one such as 0 0 "
             "1"},
        Trap{"axis_inf", "<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0 inf\"/>", 20,
             "xyz is '0 0 inf'; it must be 3 finite numbers"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Bodies, UrdfTrap,
    ::testing::Values(
        inertia("negative", "ixx=\"-0.04\" iyy=\"0.05\" izz=\"0.06\" ixy=\"0\" ixz=\"0\" iyz=\"0\"",
                " has the principal moments -0.04, 0.05, 0.06 kg m2; all must be > 0"),
        // eigenvalues of [[1, 2], [2, 1]] are -1 and 3
        inertia("not_definite", "ixx=\"1\" iyy=\"1\" izz=\"2\" ixy=\"2\" ixz=\"0\" iyz=\"0\"",
                " has the principal moments -1, 2, 3 kg m2; all must be > 0"),
        inertia("zero", "ixx=\"0\" iyy=\"0\" izz=\"0\" ixy=\"0\" ixz=\"0\" iyz=\"0\"",
                " has the principal moments 0, 0, 0 kg m2; all must be > 0"),
        inertia("triangle", "ixx=\"0.04\" iyy=\"0.05\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"",
                " has the principal moments 0.04, 0.05, 0.1 kg m2; no body has such moments: the "
                "largest "
                "must not "
                "exceed the sum of the other two"),
        inertia("incomplete", "ixx=\"0.04\" iyy=\"0.05\" izz=\"0.06\" ixy=\"0\" ixz=\"0\"",
                " has no iyz; it must have one"),
        Trap{"inertial_without_inertia", kInertia, "", 24,
             "link 'arm': has no <inertia>; a body needs its inertia"},
        Trap{"inertial_without_mass", kMass, "", 24,
             "link 'arm': has no <mass>; a body needs its mass in kg"},
        Trap{"two_masses", kMass, kMass + kMass, 26,
             "link 'arm': has a second <mass>; one is allowed"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Joints, UrdfTrap,
    ::testing::Values(limit("swapped", "lower=\"2\" upper=\"-1\" velocity=\"3\" effort=\"40\"",
                            ": lower is 2 and upper is -1 rad; lower must be <= upper"),
                      limit("velocity", "lower=\"-1\" upper=\"2\" velocity=\"-3\" effort=\"40\"",
                            ": velocity is -3; it must be >= 0"),
                      limit("effort", "lower=\"-1\" upper=\"2\" velocity=\"3\" effort=\"-40\"",
                            ": effort is -40; it must be >= 0"),
                      limit("without_effort", "lower=\"-1\" upper=\"2\" velocity=\"3\"",
                            " has no effort; it must have one"),
                      limit("infinite", "lower=\"-inf\" upper=\"2\" velocity=\"3\" effort=\"4\"",
                            ": lower is '-inf'; it must be one finite number"),
                      Trap{"no_limit", kLimit, "", 16,
                           "joint 'first': has no <limit>; a revolute joint needs one (lower and "
                           "upper in rad, velocity in "
                           "rad/s, effort in N m), or the type must be continuous"},
                      slide("without_limit", "",
                            "has no <limit>; a prismatic joint needs one (lower and upper in m, "
                            "velocity in m/s, effort in N)"),
                      slide("swapped", "lower=\"0.2\" upper=\"-1\" velocity=\"3\" effort=\"40\"",
                            "<limit>: lower is 0.2 and upper is -1 m; lower must be <= upper"),
                      slide("velocity", "lower=\"-1\" upper=\"2\" velocity=\"-3\" effort=\"40\"",
                            "<limit>: velocity is -3; it must be >= 0"),
                      slide("effort", "lower=\"-1\" upper=\"2\" velocity=\"3\" effort=\"-40\"",
                            "<limit>: effort is -40; it must be >= 0"),
                      slide("without_velocity", "lower=\"-1\" upper=\"2\" effort=\"40\"",
                            "<limit> has no velocity; it must have one"),
                      slide("infinite", "lower=\"0\" upper=\"inf\" velocity=\"3\" effort=\"4\"",
                            "<limit>: upper is 'inf'; it must be one finite number"),
                      slide("misspelt", "lower=\"0\" uper=\"1\" velocity=\"3\" effort=\"4\"",
                            "unknown attribute of <limit> 'uper'; did you mean 'upper'?"),
                      type("planar"), type("floating"),
                      Trap{"type_misspelt", "type=\"continuous\"", "type=\"continous\"", 34,
                           "joint 'second': unknown type 'continous'; did you mean 'continuous'?"},
                      Trap{"no_type", " type=\"continuous\"", "", 34,
                           "joint 'second': <joint> has no type; it must have one"},
                      Trap{"mimic", "<axis xyz=\"0 1 0\"/>", "<mimic joint=\"first\"/>", 38,
                           "joint 'second': follows another joint (<mimic>), which is not "
                           "simulated between base 'world' and tip 'tool'"},
                      Trap{"damping", "<axis xyz=\"0 1 0\"/>", "<dynamics damping=\"-1\"/>", 38,
                           "<dynamics>: damping is -1; it must be >= 0"},
                      Trap{"friction", "<axis xyz=\"0 1 0\"/>", "<dynamics friction=\"nan\"/>", 38,
                           "<dynamics>: friction is 'nan'; it must be one finite number"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Chain, UrdfTrap,
    ::testing::Values(
        Trap{"missing_child", "<child link=\"hand\"/>", "<child link=\"hnad\"/>", 36,
             "joint 'second': <child>: unknown link 'hnad'; did you mean 'hand'? Valid: arm, base, "
             "hand, tool, world"},
        Trap{"joint_without_child", "<child link=\"hand\"/>", "", 34,
             "joint 'second': has no <child>; a joint needs a parent and a child link"},
        Trap{"self_loop", "<child link=\"hand\"/>", "<child link=\"arm\"/>", 34,
             "joint 'second': joins link 'arm' to itself; parent and child must differ"},
        Trap{
            "two_roots", "<link name=\"tool\"/>", "<link name=\"tool\"/><link name=\"lost\"/>", 51,
            "the links 'world' and 'lost' both have no parent joint; exactly one link is the root"},
        Trap{"two_parents", "<link name=\"tool\"/>",
             "<link name=\"tool\"/><joint name=\"x\" type=\"fixed\"><parent link=\"arm\"/><child "
             "link=\"tool\"/></joint>",
             51,
             "link 'tool' is the child of the joints 'tool_joint' and 'x'; a link can have "
             "only one parent joint"},
        Trap{"cycle_of_all", "<link name=\"tool\"/>",
             "<link name=\"tool\"/><joint name=\"x\" type=\"fixed\"><parent link=\"tool\"/><child "
             "link=\"world\"/></joint>",
             4,
             "the links form a cycle, 'world' -> 'base' -> 'arm' -> 'hand' -> 'tool' -> 'world'; "
             "one link must "
             "be the root"},
        Trap{"cycle_beside_the_chain", "<link name=\"tool\"/>",
             "<link name=\"tool\"/><link name=\"p\"/>\n<link name=\"q\"/>"
             "<joint name=\"pq\" type=\"fixed\"><parent link=\"p\"/><child link=\"q\"/></joint>"
             "<joint name=\"qp\" type=\"fixed\"><parent link=\"q\"/><child link=\"p\"/></joint>",
             51,
             "the links form a cycle, 'p' -> 'q' -> 'p'; joints must connect every link to the "
             "root 'world'"},
        Trap{"same_link_twice", "<link name=\"tool\"/>",
             "<link name=\"tool\"/><link name=\"arm\"/>", 51,
             "link 'arm': the name is used by an earlier link; names must be unique"},
        Trap{"same_joint_twice", "name=\"tool_joint\"", "name=\"first\"", 46,
             "joint 'first': the name is used by an earlier joint; names must be unique"},
        Trap{"moving_link_without_mass", kHandInertial, "", 34,
             "joint 'second' moves link 'hand', which has no mass; give it an <inertial> element, "
             "or set robot.density_kg_per_m3 to take it from the shapes of its <visual> elements "
             "(or make the joint fixed)"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Names, UrdfTrap,
    ::testing::Values(
        Trap{"misspelt_element", "<origin xyz=\"0.6 0 0\"/>", "<orgin xyz=\"0.6 0 0\"/>", 37,
             "joint 'second': unknown element in <joint> 'orgin'; did you mean 'origin'?"},
        Trap{"misspelt_attribute", "<origin xyz=\"0.6 0 0\"/>", "<origin xzy=\"0.6 0 0\"/>", 37,
             "joint 'second': unknown attribute of <origin> 'xzy'; did you mean 'xyz'?"},
        Trap{"attribute_twice", "<mass value=\"0.5\"/>", "<mass value=\"0.5\" value=\"5\"/>", 42,
             "is not well-formed XML: an attribute is malformed or given twice"},
        Trap{"link_without_name", "<link name=\"tool\"/>", "<link/>", 51,
             "a link: <link> has no name; it must have one"},
        Trap{"escape_code_in_name", "<link name=\"tool\"/>", "<link name=\"tool&#27;[2J\"/>", 51,
             "name is 'tool?[2J'; it must be printable UTF-8"},
        Trap{"xacro_element", "<link name=\"tool\"/>", "<xacro:arm name=\"tool\"/>", 51,
             "<xacro:arm> is an element of xacro; xacro is not read: expand the file and give "
             "armwright the result. ROS 2: ros2 run xacro xacro my.urdf.xacro > my.urdf. ROS 1: "
             "rosrun xacro xacro my.urdf.xacro > my.urdf. Without ROS: pip install xacrodoc; "
             "xacrodoc my.urdf.xacro -o my.urdf. Arguments of the file follow as name:=value"},
        Trap{"xacro_expression", kMass, "<mass value=\"${2 * m}\"/>", 26,
             "value is '${2 * m}', an expression of xacro; xacro is not read"},
        Trap{"xacro_name", "<link name=\"tool\"/>", "<link name=\"${prefix}tool\"/>", 51,
             "name is '${prefix}tool', an expression of xacro; xacro is not read"},
        Trap{"robot_without_name", "<robot name=\"two_joints\">", "<robot>", 2,
             "<robot> has no name; it must have one"},
        Trap{"two_robots", "</robot>", "</robot>\n<robot name=\"second\"/>", 53,
             "has <robot> after </robot>; a URDF has one root element"},
        Trap{"doctype", "<?xml version=\"1.0\"?>", "<!DOCTYPE robot [<!ENTITY a \"aaaa\">]>", 1,
             "document types and entity declarations (<!...>) are not allowed"},
        Trap{"entity", "<link name=\"tool\"/>", "<link name=\"&tool;\"/>", 51,
             "'&' begins an unknown entity"}),
    name_of);

TEST(UrdfText, RefusesEmptyAndTruncatedFiles) {
  EXPECT_EQ(message_of(""), "robot.urdf:1: is empty; a URDF has one <robot> element");
  EXPECT_EQ(message_of(" \n\t\n"), "robot.urdf:1: is empty; a URDF has one <robot> element");
  EXPECT_THAT(message_of("<?xml version=\"1.0\"?>\n"), HasSubstr("robot.urdf:1: "));
  EXPECT_THAT(message_of("no markup at all"), StartsWith("robot.urdf:1: "));
  const std::string xml = valid_xml();
  EXPECT_EQ(message_of(xml.substr(0, xml.find("<link name=\"hand\">"))),
            "robot.urdf:40: the file ends inside <robot>, opened in line 2; is it truncated?");
  EXPECT_EQ(
      message_of(xml.substr(0, xml.find("effort=\"40\"") + 4)),
      "robot.urdf:21: the file ends inside the tag <limit that begins here; is it truncated?");
  EXPECT_EQ(message_of("<robot>\n<!-- never closed"),
            "robot.urdf:2: the file ends inside a comment that begins here; is it truncated?");
}

// A truncated file is always refused and never read as a smaller robot.
TEST(UrdfText, RefusesEveryPrefix) {
  const std::string xml = valid_xml();
  const std::size_t complete = xml.find("</robot>") + 8;
  for (std::size_t length = 0; length < complete; ++length) {
    EXPECT_THAT(message_of(xml.substr(0, length)), StartsWith("robot.urdf:")) << length;
  }
  EXPECT_EQ(message_of(xml.substr(0, complete)), "no error");
}

// Replaces every byte of a valid file by each of several dangerous bytes. The reader must accept or
// refuse the file and do nothing else.
TEST(UrdfText, SurvivesEveryByteReplaced) {
  const std::string xml = valid_xml();
  for (std::size_t at = 0; at < xml.size(); ++at) {
    for (const char byte : {'\0', '<', '>', '"', '/', '&', '-', 'e', '\xff'}) {
      std::string broken = xml;
      broken[at] = byte;
      const std::string message = message_of(broken);
      EXPECT_TRUE(message == "no error" || message.starts_with("robot.urdf:")) << message;
    }
  }
}

TEST(UrdfText, RefusesDeepNesting) {
  std::string deep = "<robot name=\"deep\">\n";
  for (int i = 0; i < 200'000; ++i) {
    deep += "<a>";
  }
  EXPECT_EQ(message_of(deep),
            "robot.urdf:2: elements are nested deeper than 64, the limit for a robot");
}

TEST(UrdfText, RefusesTooMuchOfAnything) {
  EXPECT_THAT(message_of(std::string((8u << 20) + 1, ' ')),
              HasSubstr("8388609 bytes; the limit for a robot is 8388608"));

  std::string many = "<robot name=\"many\">";
  for (int i = 0; i < 60'000; ++i) {
    many += "<a/>";
  }
  EXPECT_THAT(message_of(many), HasSubstr("has more than 50000 elements"));

  std::string links = "<robot name=\"links\">";
  for (int i = 0; i <= 1000; ++i) {
    links += "<link name=\"l" + std::to_string(i) + "\"/>";
  }
  EXPECT_THAT(message_of(links + "</robot>"),
              HasSubstr("link 'l1000': is one too many; at most 1000 links are allowed"));

  std::string attributes = "<robot";
  for (int i = 0; i < 100; ++i) {
    attributes += " a" + std::to_string(i) + "=\"\"";
  }
  EXPECT_THAT(message_of(attributes + "/>"), HasSubstr("an element has more than 64 attributes"));
}

TEST(UrdfText, RefusesOtherRoots) {
  EXPECT_EQ(message_of("\n<sdf version=\"1.6\"/>"),
            "robot.urdf:2: the file: begins with <sdf>; a URDF's root element is <robot>");
  EXPECT_THAT(message_of("<robot name=\"r\">\n</link></robot>"),
              HasSubstr("robot.urdf:1: is not well-formed XML: an element has a closing tag of "
                        "another name, or none"));
}

// Errors that are refused in a revolute joint are also refused in a prismatic one.
TEST(UrdfText, RefusesSlidersThatCannotBeSimulated) {
  const std::string xml =
      read_file(std::filesystem::path(ARMWRIGHT_TEST_DATA) / "urdf/rail_and_pole.urdf", 1 << 20);
  const std::string axis = "<axis xyz=\"0 2 0\"/>";
  EXPECT_EQ(message_of(xml), "no error");
  EXPECT_EQ(message_of(replace(xml, axis, "<axis xyz=\"0 0 0\"/>")),
            "robot.urdf:8: joint 'rail': <axis>: xyz is '0 0 0', which has no direction; give one "
            "such as 0 0 1");
  EXPECT_THAT(message_of(replace(xml, axis, axis + "<mimic joint=\"pivot\"/>")),
              StartsWith("robot.urdf:8: joint 'rail': follows another joint (<mimic>)"));
  const std::size_t from = xml.find("    <inertial>"), to = xml.find("</inertial>") + 11;
  EXPECT_EQ(message_of(std::string(xml).erase(from, to - from)),
            "robot.urdf:4: joint 'rail' moves link 'cart', which has no mass; give it an "
            "<inertial> element, or set robot.density_kg_per_m3 to take it from the shapes of its "
            "<visual> elements (or make the joint fixed)");
}

TEST(UrdfText, RefusesRobotsThatCannotMove) {
  EXPECT_EQ(message_of("<robot name=\"r\"/>"),
            "robot.urdf:1: the file: <robot> has no <link>; it needs a chain of links and joints");
  EXPECT_EQ(message_of("<robot name=\"r\">\n<link name=\"a\"/></robot>"),
            "robot.urdf:2: the robot has no moving joint; it needs at least one revolute, "
            "continuous or prismatic joint");
}

TEST(UrdfText, ShowsOnlyTheBeginningOfLongValues) {
  const std::string message = message_of(
      replace(valid_xml(), kMass, "<mass value=\"" + std::string(100'000, 'x') + "\"/>"));
  EXPECT_THAT(message, HasSubstr("value is '" + std::string(80, 'x') + "...'"));
  EXPECT_LT(message.size(), 300u);
}

// Legal but unusual contents must be accepted and read correctly.
TEST(UrdfText, AcceptsUnusualButLegalXml) {
  std::string xml = valid_xml();
  xml = replace(xml, kMass, "<mass value=' +1.5e0\t' />");
  xml = replace(xml, "<link name=\"tool\"/>",
                "<link name='t>o/o&amp;l'/><!-- <link name='tool'/> -->");
  xml = replace(xml, "<child link=\"tool\"/>", "<child link='t&#62;o/o&#38;l'></child>");
  xml = replace(xml, "</robot>",
                "<gazebo><![CDATA[ <a><b> & ]]></gazebo><transmission name=\"x\"/></robot>");
  const RobotModel model = parse_urdf(xml, "robot.urdf");
  EXPECT_EQ(model.links[0].inertial.mass_kg, 1.5);
  EXPECT_EQ(model.joint_count(), 2u);
}

// A plate's moments, the sum of the smaller ones rounded down in the third digit.
TEST(UrdfText, AcceptsTheRoundedMomentsOfAPlate) {
  EXPECT_EQ(
      message_of(replace(
          valid_xml(), kInertia,
          "<inertia ixx=\"1.333\" iyy=\"1.333\" izz=\"2.667\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>")),
      "no error");
}

TEST(UrdfText, CollisionsAreNotRead) {
  EXPECT_EQ(message_of(replace(valid_xml(), "<link name=\"tool\"/>",
                               "<link name=\"tool\"><collision><geometry><box "
                               "size=\"nan\"/></geometry></collision></link>")),
            "no error");
}

TEST(UrdfText, AnotherVersionOfUrdfIsRefused) {
  EXPECT_THAT(message_of(replace(valid_xml(), "<robot name=\"two_joints\">",
                                 "<robot name=\"two_joints\" version=\"7.0\">")),
              HasSubstr("<robot>: version is '7.0'; it must be 1.0, or left out"));
  EXPECT_EQ(message_of(replace(valid_xml(), "<robot name=\"two_joints\">",
                               "<robot name=\"two_joints\" version=\"1.0\">")),
            "no error");
}

TEST(UrdfText, NothingIsPrinted) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  message_of(valid_xml());
  message_of("<robot");
  message_of(replace(valid_xml(), "<robot name=\"two_joints\">",
                     "<robot name=\"two_joints\" version=\"7.0\">"));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(UrdfFile, MessagesNameTheFile) {
  const std::filesystem::path folder = std::filesystem::path(ARMWRIGHT_TEST_DATA) / "urdf";
  try {
    load_urdf(folder / "negative_mass.urdf");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              (folder / "negative_mass.urdf").string() +
                  ":9: link 'arm': <mass>: value is -2.5; it must be > 0");
  }
  try {
    load_urdf(folder / "missing.urdf");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_THAT(error.what(), HasSubstr("missing.urdf: cannot open it: No such file"));
  }
}

}  // namespace
}  // namespace armwright
