// Tests what the reader repairs, what it still refuses, and that a mended file needs no repair.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/temporary_folder.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/urdf_writer.hpp"

namespace armwright {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string write_tensor(const std::string& ixx, const std::string& iyy, const std::string& izz) {
  return "<inertia ixx=\"" + ixx + "\" iyy=\"" + iyy + "\" izz=\"" + izz +
         "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>";
}

// Two joints with effort limits, a sensor on a fixed joint, and a flange. The parts in braces are
// replaced by tests.
const std::string kFoot = "<visual><geometry><box size=\"0.2 0.2 0.1\"/></geometry></visual>";
const std::string kUpper = "<mass value=\"4\"/>" + write_tensor("0.05", "0.06", "0.02");
const std::string kSensor = "<mass value=\"0.1\"/>" + write_tensor("1e-4", "1e-4", "1e-4");

struct Parts {
  std::string top = {};  // before the links
  std::string foot = kFoot;
  std::string upper = "<inertial><origin xyz=\"0 0 0.2\"/>" + kUpper + "</inertial>";
  std::string lower = "<inertial>" + kUpper + "</inertial>";
  std::string sensor = "<inertial><origin xyz=\"0 0.1 0\"/>" + kSensor + "</inertial>";
  std::string effort = "100";
};

std::string make_blemished(const Parts& parts) {
  return "<robot name=\"arm\">\n" + parts.top + "\n  <link name=\"foot\">\n    " + parts.foot +
         "\n  </link>\n  <joint name=\"swing\" type=\"revolute\"><parent link=\"foot\"/>"
         "<child link=\"upper\"/><origin xyz=\"0 0 0.3\"/><axis xyz=\"0 1 0\"/>"
         "<limit lower=\"-2\" upper=\"2\" velocity=\"2\" effort=\"" +
         parts.effort +
         "\"/></joint>\n"
         "  <link name=\"upper\">\n    " +
         parts.upper +
         "\n  </link>\n  <joint name=\"bend\" type=\"revolute\"><parent link=\"upper\"/>"
         "<child link=\"lower\"/><origin xyz=\"0 0 0.4\"/><axis xyz=\"0 1 0\"/>"
         "<limit lower=\"-2\" upper=\"2\" velocity=\"2\" effort=\"" +
         parts.effort +
         "\"/></joint>\n"
         "  <link name=\"lower\">" +
         parts.lower +
         "</link>\n"
         "  <joint name=\"hold\" type=\"fixed\"><parent link=\"lower\"/><child "
         "link=\"sensor\"/></joint>\n"
         "  <link name=\"sensor\">\n    " +
         parts.sensor +
         "\n  </link>\n"
         "  <joint name=\"end\" type=\"fixed\"><parent link=\"lower\"/><child link=\"flange\"/>"
         "<origin xyz=\"0 0 0.35\"/></joint>\n  <link name=\"flange\"/>\n</robot>\n";
}

constexpr bool kRepair = true;

RobotModel read(const Parts& parts, bool repair = false) {
  return parse_urdf(make_blemished(parts), "arm.urdf", {.repair = repair});
}

std::string refusal_of_parts(const Parts& parts, bool repair = false) {
  try {
    read(parts, repair);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    return error.what();
  }
  return "no error";
}

std::vector<std::string> list_repairs(const RobotModel& robot) {
  std::vector<std::string> lines;
  for (const UrdfRepair& repair : robot.reading.repairs) {
    lines.push_back(repair.what);
  }
  return lines;
}

// The mended file is read strictly, and every number of the robot is the same.
void expect_mended(const Parts& parts) {
  const std::string xml = make_blemished(parts);
  const RobotModel robot = read(parts, kRepair);
  const std::string mended = apply_repairs(xml, "arm.urdf", robot.reading.repairs, "by a test");
  const RobotModel again = parse_urdf(mended, "mended.urdf");
  EXPECT_THAT(list_repairs(again), IsEmpty()) << mended;
  ASSERT_EQ(again.joint_count(), robot.joint_count());
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const Inertial& a = robot.links[i].inertial;
    const Inertial& b = again.links[i].inertial;
    EXPECT_EQ(a.mass_kg, b.mass_kg) << i;
    EXPECT_EQ(a.com_m, b.com_m) << i;
    EXPECT_EQ(a.inertia_kg_m2, b.inertia_kg_m2) << i;
    EXPECT_EQ(robot.links[i].visuals.size(), again.links[i].visuals.size()) << i;
  }
  EXPECT_EQ(robot.base.visuals.size(), again.base.visuals.size());
  for (std::size_t i = 0; i < robot.base.visuals.size(); ++i) {
    EXPECT_EQ(robot.base.visuals[i].rgba, again.base.visuals[i].rgba);
  }
}

std::string make_looks(const std::string& shape, const std::string& materials = "") {
  return "<visual><geometry>" + shape + "</geometry>" + materials + "</visual>";
}
const std::string kSphereShape = "<sphere radius=\"0.1\"/>";

TEST(UrdfRepair, AnArmWithoutBlemishesIsReadAsBefore) {
  const RobotModel strict = read({});
  const RobotModel repaired = read({}, kRepair);
  EXPECT_THAT(list_repairs(repaired), IsEmpty());
  EXPECT_EQ(strict.notes, repaired.notes);
  EXPECT_EQ(strict.links[1].inertial.inertia_kg_m2, repaired.links[1].inertial.inertia_kg_m2);
}

// Of several materials, the first one with a colour counts: its own, or that of its name.
TEST(UrdfRepair, AVisualHasOneMaterial) {
  Parts parts;
  parts.top = "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material>";
  parts.foot = make_looks(kSphereShape,
                          "<material name=\"red\"/>\n<material name=\"green\">"
                          "<color rgba=\"0 1 0 1\"/></material>");
  const RobotModel robot = read(parts);
  EXPECT_EQ(robot.base.visuals[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
  EXPECT_THAT(list_repairs(robot),
              ElementsAre("a <visual> has one <material>; the first usable one counts: 'foot' "
                          "(line 4)"));
  expect_mended(parts);
  parts.foot = make_looks(kSphereShape,
                          "<material name=\"nobody\"/><material name=\"green\">"
                          "<color rgba=\"0 1 0 1\"/></material>");
  EXPECT_EQ(read(parts).base.visuals[0].rgba, Eigen::Vector4d(0, 1, 0, 1));
  expect_mended(parts);
}

TEST(UrdfRepair, OfMaterialsOfTheSameNameTheFirstCounts) {
  Parts parts;
  parts.top =
      "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material>"
      "<material name=\"red\"><color rgba=\"0 0 1 1\"/></material>";
  parts.foot = make_looks(kSphereShape, "<material name=\"red\"/>");
  EXPECT_EQ(read(parts).base.visuals[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
}

TEST(UrdfRepair, AnUnknownMaterialIsGrey) {
  Parts parts;
  parts.top = "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material>";
  parts.foot = make_looks(kSphereShape, "<material name=\"rde\"/>");
  const RobotModel robot = read(parts);
  EXPECT_EQ(robot.base.visuals[0].rgba, VisualShape{}.rgba);
  EXPECT_THAT(list_repairs(robot),
              ElementsAre("unknown material 'rde'; did you mean 'red'? Valid: red; the shape is "
                          "grey: 'foot' (line 4)"));
  expect_mended(parts);
}

TEST(UrdfRepair, AMaterialThatCannotBeUsedIsLeftOut) {
  Parts parts;
  parts.top = "<material name=\"red\"><color rgba=\"255 0 0 1\"/></material>";
  parts.foot = make_looks(kSphereShape, "<material name=\"red\"/>");
  EXPECT_THAT(
      list_repairs(read(parts)),
      ElementsAre("a <material> that cannot be used is left out: line 2: <color>: rgba has "
                  "the part 255; each must be in [0, 1]",
                  "unknown material 'red'. Valid: (none); the shape is grey: 'foot' (line 4)"));
  expect_mended(parts);
}

TEST(UrdfRepair, AShapeWithoutSizeIsLeftOut) {
  for (const std::string shape :
       {"<box size=\"0 0 0\"/>", "<box size=\"0.1 0 0.1\"/>", "<sphere radius=\"0\"/>",
        "<cylinder radius=\"0.1\" length=\"0\"/>", "<cylinder radius=\"0\" length=\"0.1\"/>"}) {
    Parts parts;
    parts.foot = make_looks(shape) + make_looks(kSphereShape);
    const RobotModel robot = read(parts);
    EXPECT_EQ(robot.base.visuals.size(), 1u) << shape;
    EXPECT_THAT(list_repairs(robot),
                ElementsAre("a <visual> of size 0 is left out: 'foot' (line 4)"));
    expect_mended(parts);
  }
}

TEST(UrdfRepair, AShapeThatCannotBeShownIsLeftOut) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {make_looks("<capsule radius=\"0.1\" length=\"1\"/>"),
       "unknown shape 'capsule'. Valid: box, cylinder, sphere, mesh (write a capsule as three "
       "<visual>, a cylinder and a sphere at each end)"},
      {make_looks(""), "<geometry> must hold exactly one of box, cylinder, sphere, mesh"},
      {make_looks("<box size=\"0.6 -0.1 0.1\"/>"),
       "<box>: size is '0.6 -0.1 0.1'; all three edges must be > 0"},
      {"<visual><orgin xyz=\"0 0 1\"/></visual>",
       "unknown element in <visual> 'orgin'; did you mean 'origin'?"}};
  for (const auto& [visual, reason] : cases) {
    Parts parts;
    parts.foot = visual;
    const RobotModel robot = read(parts);
    EXPECT_THAT(robot.base.visuals, IsEmpty());
    EXPECT_THAT(list_repairs(robot),
                ElementsAre(AllOf(StartsWith("a <visual> that cannot be shown is left out: "
                                             "'foot' (line 4: "),
                                  HasSubstr(reason))));
    expect_mended(parts);
  }
}

// A mass that comes from shapes needs them all, except those without size.
TEST(UrdfRepair, AMassNeedsTheShapesThatItComesFrom) {
  Parts parts;
  parts.upper = make_looks(kSphereShape) + make_looks("<box size=\"0 0 0\"/>");
  const std::string xml = make_blemished(parts);
  EXPECT_NEAR(parse_urdf(xml, "arm.urdf", {.density_kg_per_m3 = 1000}).links[0].inertial.mass_kg,
              4000 * std::numbers::pi / 3 * 1e-3, 1e-12);
  parts.upper = make_looks(kSphereShape) + make_looks("<capsule radius=\"0.1\"/>");
  try {
    parse_urdf(make_blemished(parts), "arm.urdf", {.density_kg_per_m3 = 1000});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                StartsWith("arm.urdf: link 'upper': its mass comes from its <visual> elements, and "
                           "one of them has none (line 8: unknown shape 'capsule'"));
  }
}

// Whatever is wrong with the mass of the base does not matter.
TEST(UrdfRepair, TheInertialOfALinkThatDoesNotMoveIsLeftOut) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"<inertial><mass value=\"3\"/>" + write_tensor("1", "1", "9") + "</inertial>",
       "<inertia> has the principal moments 1, 1, 9 kg m2; no body has such moments"},
      {"<inertial><mass value=\"3\"/>" + write_tensor("0", "0", "0") + "</inertial>",
       "all must be > 0"},
      {"<inertial><mass value=\"0\"/>" + write_tensor("1", "1", "1") + "</inertial>",
       "<mass>: value is 0; it must be > 0"},
      {"<inertial><mass value=\"-3\"/>" + write_tensor("1", "1", "1") + "</inertial>",
       "<mass>: value is -3; it must be > 0"},
      {"<inertial><mass value=\"3\"/></inertial>", "has no <inertia>"},
      {"<inertial><mass value=\"nan\"/>" + write_tensor("1", "1", "1") + "</inertial>",
       "it must be one finite number"}};
  for (const auto& [inertial, reason] : cases) {
    Parts parts;
    parts.foot = inertial;
    const RobotModel robot = read(parts);
    EXPECT_EQ(robot.base.inertial.mass_kg, 0);
    EXPECT_THAT(list_repairs(robot),
                ElementsAre(AllOf(StartsWith("the <inertial> of a link that does not move "
                                             "is left out: 'foot' (line 4: "),
                                  HasSubstr(reason))));
    expect_mended(parts);
  }
}

// diag(1, 2, 3.1) lacks 0.1, so that both smaller moments are raised by 0.05, whatever the axes.
TEST(UrdfRepair, RaisesTheSmallerMomentsOfAPlate) {
  Parts parts;
  parts.upper = "<inertial><origin xyz=\"0.1 0 0.2\" rpy=\"0.3 0.2 0.1\"/><mass value=\"9\"/>" +
                write_tensor("1", "3.1", "2") + "</inertial>";
  EXPECT_THAT(refusal_of_parts(parts), HasSubstr("no body has such moments"));
  const RobotModel robot = read(parts, kRepair);
  EXPECT_THAT(list_repairs(robot),
              ElementsAre("the smaller moments of an <inertia> are raised until their sum is the "
                          "largest, as in a flat body: 'upper' (line 8, 3.3 % were missing)"));
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(robot.links[0].inertial.inertia_kg_m2)
          .eigenvalues();
  EXPECT_LT((moments - Eigen::Vector3d(1.05, 2.05, 3.1)).norm(), 1e-14);
  expect_mended(parts);
  parts.upper = "<inertial><mass value=\"9\"/>" + write_tensor("1", "3.2", "2") + "</inertial>";
  EXPECT_THAT(refusal_of_parts(parts, kRepair), HasSubstr("no body has such moments"))
      << "6.7 % are no rounding";
}

// A part on a fixed joint: its mass stays where it is, and its own inertia is that of a ball.
TEST(UrdfRepair, APartWithAnInertiaThatNoBodyHasCountsAsABall) {
  for (const std::string& tensor : {write_tensor("0", "0", "0"), write_tensor("0", "0", "0.002"),
                                    write_tensor("1e-4", "1e-4", "1")}) {
    Parts parts;
    parts.sensor =
        "<inertial><origin xyz=\"0 0.1 0\"/><mass value=\"0.1\"/>" + tensor + "</inertial>";
    EXPECT_THAT(refusal_of_parts(parts), HasSubstr("<inertia> has the principal moments"));
    const RobotModel robot = read(parts, kRepair);
    EXPECT_THAT(list_repairs(robot),
                ElementsAre(StartsWith("an <inertia> that no body has is left out, and the link "
                                       "counts as a ball of 1000 kg/m3: 'sensor' (line 14, 0.1 kg, "
                                       "moments ")));
    // 0.1 kg at 1000 kg/m3 have a radius of 28.79 mm, so 0.4 m r^2 = 3.316e-5 kg m2.
    const double radius_m = std::cbrt(3 * 1e-4 / (4 * std::numbers::pi));
    const double distance_m = 0.1 * 4 / 4.1;  // of the sensor from the common centre of mass
    const double expected = 0.05 + 0.4 * 0.1 * radius_m * radius_m + 0.1 * distance_m * distance_m +
                            4 * std::pow(0.1 - distance_m, 2);
    EXPECT_NEAR(robot.links[1].inertial.inertia_kg_m2(0, 0), expected, 1e-15);
    EXPECT_DOUBLE_EQ(robot.links[1].inertial.mass_kg, 4.1);
    expect_mended(parts);
  }
}

TEST(UrdfRepair, AMassOfZeroWithAnInertiaIsLeftOut) {
  Parts parts;
  parts.sensor = "<inertial><mass value=\"0\"/>" + write_tensor("1", "1", "1") + "</inertial>";
  EXPECT_THAT(refusal_of_parts(parts), HasSubstr("<mass>: value is 0; it must be > 0"));
  EXPECT_THAT(list_repairs(read(parts, kRepair)),
              ElementsAre("an <inertial> with mass 0 is left out: 'sensor' (line 14)"));
  expect_mended(parts);
}

// What matters is refused with all of it, in the order of the lines.
TEST(UrdfFaults, AreToldAllAtOnce) {
  Parts parts;
  parts.upper = "<inertial><mass value=\"-4\"/>" + write_tensor("1", "1", "x") + "</inertial>";
  parts.lower = "";
  parts.sensor = "";
  parts.effort = "-5";
  EXPECT_EQ(
      refusal_of_parts(parts),
      "arm.urdf: 5 things to mend\n"
      "arm.urdf:6: joint 'swing': <limit>: effort is -5; it must be >= 0\n"
      "arm.urdf:8: link 'upper': <mass>: value is -4; it must be > 0\n"
      "arm.urdf:8: link 'upper': <inertia>: izz is 'x'; it must be one finite number of at "
      "most 1e+18, with a decimal point and no unit\n"
      "arm.urdf:10: joint 'bend': <limit>: effort is -5; it must be >= 0\n"
      "arm.urdf:10: joint 'bend' moves link 'lower', which has no mass; give it an <inertial> "
      "element, or set robot.density_kg_per_m3 to take it from the shapes of its <visual> "
      "elements (or make the joint fixed)");
}

TEST(UrdfFaults, OneAloneIsToldAsItself) {
  EXPECT_THAT(refusal_of_parts({.effort = "100\" uper=\"3"}), HasSubstr("2 things to mend\n"));
  EXPECT_THAT(refusal_of_parts({.upper = ""}),
              StartsWith("arm.urdf:6: joint 'swing' moves link 'upper', which has no mass; "));
}

// A misspelt part hides the rest of its joint, and its link's mass is told all the same.
TEST(UrdfFaults, NameTheJointOfAMisspeltPart) {
  Parts parts;
  parts.upper = "";
  std::string xml = make_blemished(parts);
  xml.replace(xml.find("<origin"), 7, "<orgin");
  try {
    parse_urdf(xml, "arm.urdf");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(StartsWith("arm.urdf: 2 things to mend\narm.urdf:6: joint 'swing': unknown "
                                 "element in <joint> 'orgin'"),
                      HasSubstr("arm.urdf:6: joint 'swing' moves link 'upper'")));
  }
}

TEST(UrdfFaults, AfterTwentyTheyAreCounted) {
  std::string links;
  for (int i = 0; i < 25; ++i) {
    links += "<link name=\"foot\"/>\n";
  }
  const std::string message = refusal_of_parts({.top = links});
  EXPECT_THAT(message, StartsWith("arm.urdf: 25 things to mend\narm.urdf:3: link 'foot': the name "
                                  "is used by an earlier link"));
  EXPECT_THAT(message, HasSubstr("\nand 5 more"));
}

TEST(UrdfFaults, XacroIsToldAlone) {
  Parts parts;
  parts.upper = "<inertial><mass value=\"-4\"/>" + write_tensor("1", "1", "${m}") + "</inertial>";
  EXPECT_THAT(refusal_of_parts(parts),
              StartsWith("arm.urdf:8: link 'upper': <inertia>: izz is '${m}', an "
                         "expression of xacro; xacro is not read: "));
}

// The rule of assumed_mass.hpp by hand: ways of 0.4 and 0.35 m, L = 0.75 m.
TEST(AssumedMass, IsThatOfATaperedArm) {
  Parts parts;
  parts.upper = "";
  parts.lower = "";
  parts.sensor = "";
  parts.effort = "1000";
  const RobotModel robot = read(parts, kRepair);
  const double first = 0.75 / 7, second = 0.75 / 14 * (1 + 0.35 / 0.75);
  const double first_kg = 1000 * std::numbers::pi / 4 * first * first * 0.4;
  EXPECT_NEAR(robot.links[0].inertial.mass_kg, first_kg, 1e-12);
  EXPECT_NEAR(robot.links[1].inertial.mass_kg, 1000 * std::numbers::pi / 4 * second * second * 0.35,
              1e-12);
  EXPECT_LT((robot.links[0].inertial.com_m - Eigen::Vector3d(0, 0, 0.2)).norm(), 1e-15);
  const Eigen::Matrix3d& tensor = robot.links[0].inertial.inertia_kg_m2;
  EXPECT_NEAR(tensor(2, 2), first_kg * first * first / 8, 1e-14);
  EXPECT_NEAR(tensor(0, 0), first_kg / 12 * (0.75 * first * first + 0.4 * 0.4), 1e-14);
  EXPECT_THAT(robot.reading.assumed_links, ElementsAre("upper", "lower"));
  EXPECT_THAT(
      robot.notes,
      ElementsAre(
          "the tip is taken to be 'flange'; the other ends are 'sensor'; robot.tip or --tip "
          "names another",
          "moving links for which the file states no mass: 2 of 2. Their masses are "
          "assumed, and all results depend on them; state <inertial> elements, or set "
          "robot.density_kg_per_m3 to take masses from shapes",
          "assumed masses: 'upper' 3.61 kg, 'lower' 1.7 kg. Each link is a solid "
          "cylinder of 1000 kg/m3 from its joint to the next, 0.107 m thick where the arm "
          "begins and 0.0536 m at the tip (1/7 and 1/14 of its length of 0.75 m)"));
  expect_mended(parts);
}

// The stretched arm of the test above weighs on its first joint with 9.81 (0.2 m1 + 0.575 m2) N m.
TEST(AssumedMass, LeavesTheMotorsTheirShare) {
  Parts parts;
  parts.upper = "";
  parts.lower = "";
  parts.sensor = "";
  parts.effort = "1000";
  const RobotModel heavy = read(parts, kRepair);
  parts.effort = "5";
  const RobotModel light = read(parts, kRepair);
  const auto calc_weight = [](const RobotModel& robot) {
    return 9.81 * (0.2 * robot.links[0].inertial.mass_kg + 0.575 * robot.links[1].inertial.mass_kg);
  };
  ASSERT_GT(calc_weight(heavy), 0.6 * 5);
  EXPECT_NEAR(calc_weight(light), 0.6 * 5, 1e-12);
  EXPECT_THAT(light.notes.back(),
              HasSubstr("so that gravity takes at most 60 % of the effort limits"));
  expect_mended(parts);
}

TEST(AssumedMass, IsOnlyForLinksWithoutMass) {
  Parts parts;
  parts.upper = "<inertial><mass value=\"0\"/>" + write_tensor("0", "0", "0") + "</inertial>";
  const RobotModel robot = read(parts, kRepair);
  EXPECT_THAT(robot.reading.assumed_links, ElementsAre("upper"));
  EXPECT_DOUBLE_EQ(robot.links[1].inertial.mass_kg, 4.1);
  expect_mended(parts);
  EXPECT_THAT(refusal_of_parts(parts),
              HasSubstr("joint 'swing' moves link 'upper', which has no mass"));
}

// All shapes can be read, so that masses come from them, also that of the sensor.
TEST(AssumedMass, ComesFromShapesWhereTheyCanBeRead) {
  Parts parts;
  parts.upper = make_looks(kSphereShape);
  parts.lower = make_looks("<box size=\"0.1 0.2 0.3\"/>");
  parts.sensor = make_looks("<box size=\"0.1 0.1 0.1\"/>");
  const RobotModel robot = read(parts, kRepair);
  EXPECT_NEAR(robot.links[0].inertial.mass_kg, 4000 * std::numbers::pi / 3 * 1e-3, 1e-12);
  EXPECT_NEAR(robot.links[1].inertial.mass_kg, 6 + 1, 1e-12);
  EXPECT_EQ(robot.reading.density_kg_per_m3, 1000);
  EXPECT_THAT(robot.reading.assumed_links, IsEmpty());
  EXPECT_THAT(robot.notes,
              testing::Contains("link 'lower' has no <inertial>: 6 kg and their inertia "
                                "come from its shape at 1000 kg/m3"));
  // One mesh is missing: then all masses follow from the lengths.
  parts.lower = make_looks("<mesh filename=\"package://nobody/a.stl\"/>");
  const RobotModel other = read(parts, kRepair);
  EXPECT_THAT(other.reading.assumed_links, ElementsAre("upper", "lower"));
  EXPECT_EQ(other.reading.density_kg_per_m3, 0);
}

TEST(AssumedMass, FollowsFromLengthsIfShapesShallNotCount) {
  Parts parts;
  parts.upper = make_looks(kSphereShape);
  const RobotModel robot =
      parse_urdf(make_blemished(parts), "arm.urdf", {.repair = true, .mass_from_shapes = false});
  EXPECT_THAT(robot.reading.assumed_links, ElementsAre("upper"));
}

// A link with mass keeps what the file says, also where other parts of it have shapes only.
TEST(AssumedMass, ChangesNoArmThatHasItsMasses) {
  Parts parts;
  parts.sensor = make_looks(kSphereShape);
  EXPECT_EQ(read(parts).links[1].inertial.mass_kg, read(parts, kRepair).links[1].inertial.mass_kg);
}

// Whatever one byte makes of a file with blemishes: if it is read, its mended text is read strictly.
TEST(ApplyRepairs, MendsWhateverIsRead) {
  Parts parts;
  parts.foot = make_looks(kSphereShape, "<material name=\"nobody\"/>") +
               "<inertial><mass value=\"0\"/>" + write_tensor("1", "1", "1") + "</inertial>";
  parts.upper = "<inertial><mass value=\"9\"/>" + write_tensor("1", "3.1", "2") + "</inertial>";
  parts.lower = "";
  parts.sensor = make_looks("<box size=\"0 0 0\"/>");
  const std::string xml = make_blemished(parts);
  std::size_t read_count = 0;
  for (std::size_t at = 0; at < xml.size(); ++at) {
    for (const char byte : {'<', '/', '"', '0', '-', '9'}) {
      std::string changed = xml;
      changed[at] = byte;
      RobotModel robot;
      try {
        robot = parse_urdf(changed, "arm.urdf", {.repair = true});
      } catch (const Error&) {
        continue;
      }
      ++read_count;
      const std::string mended =
          apply_repairs(changed, "arm.urdf", robot.reading.repairs, "by a test");
      try {
        EXPECT_THAT(parse_urdf(mended, "mended.urdf").reading.repairs, IsEmpty()) << mended;
      } catch (const Error& error) {
        ADD_FAILURE() << error.what() << "\n" << mended;
      }
    }
  }
  EXPECT_GT(read_count, xml.size() / 2) << "most changes are refused";
}

TEST(ApplyRepairs, ChangesNothingElse) {
  Parts parts;
  parts.foot = make_looks(kSphereShape, "<material name=\"nobody\"/>") + "\n    " +
               make_looks("<box size=\"0 0 0\"/>") + "\n    <!-- <visual/> -->";
  const std::string mended =
      apply_repairs(make_blemished(parts), "arm.urdf", read(parts).reading.repairs, "two edits");
  Parts expected;
  expected.foot = make_looks(kSphereShape) + "\n    <!-- <visual/> -->";
  EXPECT_EQ(mended, "<!--\ntwo edits\n-->\n" + make_blemished(expected));
}

}  // namespace
}  // namespace armwright
