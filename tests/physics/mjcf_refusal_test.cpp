// Arms in MJCF that are refused: the message has the place and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "base/temporary_folder.hpp"
#include "mjcf_texts.hpp"
#include "sim/robot/robot_model.hpp"

#ifdef ARMWRIGHT_WITH_MUJOCO

namespace armwright::physics_test {
namespace {

using testing::HasSubstr;

TEST(MjcfRefusal, OfAMeshThatGivesAMassAndIsMissing) {
  EXPECT_EQ(describe_mjcf_refusal(make_hinge_arm(kMjcfCover + "/>", kMjcfMesh)),
            "arm.xml:4: body 'arm': its mass comes from meshes, and there is no file "
            "'parts/Cover.OBJ'; put it there, or give the body an <inertial>");
}

TEST(MjcfRefusal, OfJointsThatAreNotSimulatedOnTheChain) {
  const auto refuse = [](const std::string& joints) {
    return describe_mjcf_refusal(
        make_hinge_arm(kMjcfBar + "<body name=\"hand\">" + joints + kMjcfBar + "</body>"));
  };
  EXPECT_EQ(
      refuse("<joint name=\"wrist\" type=\"ball\"/>"),
      "arm.xml:6: joint 'wrist': its type is ball; between base 'world' and tip 'hand' only "
      "hinge and slide joints are simulated: name a base below it (robot.base or --base), such "
      "as 'hand'");
  EXPECT_EQ(
      refuse("<joint name=\"x\"/><joint name=\"y\"/>"),
      "arm.xml:6: joint 'y': is the second joint of body 'hand'; between base 'world' and tip "
      "'hand' each joint needs a body with a mass of its own: put a body with an <inertial> "
      "between the joints, or name a base below them (robot.base or --base)");
  EXPECT_EQ(refuse("<joint name=\"x\" type=\"slide\"/>"),
            "arm.xml:6: joint 'x': slides and has no range; give it one, in m");
  EXPECT_EQ(refuse("<joint name=\"x\" stiffness=\"3\"/>"),
            "arm.xml:6: joint 'x': has a spring (stiffness 3) and no range; a spring is simulated "
            "over a finite range of at most one turn: give the joint such a range, or set its "
            "stiffness to 0");
  EXPECT_THAT(
      refuse("<joint stiffness=\"3\" range=\"-4 4\"/>"),
      HasSubstr("arm.xml:6: body 'hand': joint #1: has a spring (stiffness 3) and a range of "
                "more than one turn"));
}

TEST(MjcfRefusal, OfConstraintsAndTendonsThatActOnTheChain) {
  const std::string bodies = kMjcfBar +
                             "<site name=\"a\"/><body name=\"hand\"><joint name=\"wrist\"/>" +
                             kMjcfBar + "<site name=\"b\"/></body>";
  const auto refuse = [&](const std::string& after) {
    return describe_mjcf_refusal(make_hinge_arm(bodies, after));
  };
  constexpr const char* kEnd =
      " acts on the chain between base 'world' and tip 'hand', which is not simulated: remove it, "
      "or "
      "name another base or tip (robot.base, robot.tip, --base, --tip)";
  const std::string equality = std::string("arm.xml:10: this equality constraint") + kEnd;
  const std::string tendon = std::string("arm.xml:10: this tendon") + kEnd;
  EXPECT_EQ(refuse("<equality>\n<joint joint1=\"hinge\" joint2=\"wrist\"/></equality>"), equality);
  EXPECT_EQ(refuse("<equality>\n<joint joint1=\"wrist\"/></equality>"), equality);
  EXPECT_EQ(refuse("<equality>\n<connect body1=\"hand\" anchor=\"0 0 1\"/></equality>"), equality);
  EXPECT_EQ(refuse("<equality>\n<weld body1=\"arm\" body2=\"hand\"/></equality>"), equality);
  EXPECT_EQ(refuse("<equality>\n<weld body1=\"arm\" body2=\"hand\" active=\"false\"/></equality>"),
            "it was read");
  EXPECT_EQ(refuse("<tendon>\n<fixed><joint joint=\"wrist\" coef=\"1\"/></fixed></tendon>"),
            tendon);
  EXPECT_EQ(refuse("<tendon>\n<spatial><site site=\"a\"/><site site=\"b\"/></spatial></tendon>"),
            tendon);
}

TEST(MjcfRefusal, OfABaseOrTipThatIsNone) {
  EXPECT_EQ(
      describe_mjcf_refusal(make_hinge_arm(kMjcfBar + "<body name=\"hand\"/>"), {.tip = "hans"}),
      "arm.xml: unknown link 'hans'; did you mean 'hand'? Valid: world, arm, hand");
  EXPECT_THAT(describe_mjcf_refusal(
                  make_hinge_arm(kMjcfBar + "<body name=\"left\"/><body name=\"right\"/>")),
              HasSubstr("arm.xml: the links branch and end in 'left', 'right'; name the one"));
  EXPECT_THAT(describe_mjcf_refusal(make_hinge_arm(kMjcfBar, "<asset/>"), {.base = "arm"}),
              HasSubstr("no joint between the base 'arm' and the tip 'arm' moves"));
  EXPECT_EQ(
      describe_mjcf_refusal("<mujoco><worldbody/></mujoco>"),
      "arm.xml:1: the robot has no moving joint; it needs at least one revolute, continuous or "
      "prismatic joint");
  EXPECT_EQ(describe_mjcf_refusal(make_hinge_arm(kMjcfBar), {.density_kg_per_m3 = 2700}),
            "arm.xml: is MJCF, which gives every geom a density; leave the setting out");
}

// A few letters of it can fill the memory.
TEST(MjcfRefusal, OfCompositeBodies) {
  EXPECT_EQ(
      describe_mjcf_refusal(make_hinge_arm(
          kMjcfBar + "\n<composite type=\"grid\" count=\"9999 9999 1\" spacing=\"1\"/>")),
      "arm.xml:7: <composite> makes bodies by the thousand, which no arm needs; remove it, or "
      "give armwright the file of the arm alone");
}

// The library's message names the line in the file, also in an included one.
TEST(MjcfRefusal, OfWhatTheLibraryDoesNotTakeNamesTheElementAndTheLine) {
  EXPECT_EQ(describe_mjcf_refusal(make_hinge_arm(kMjcfBar + "\n<geom shape=\"box\"/>")),
            "arm.xml:7: MuJoCo 2.2.2 does not take the file: XML Error: Schema violation: "
            "unrecognized attribute: 'shape' Element 'geom'; change or remove what it names");
  EXPECT_EQ(
      describe_mjcf_refusal(make_hinge_arm("")),
      "arm.xml:4: MuJoCo 2.2.2 does not take the file: Error: mass and inertia of moving bodies "
      "must be larger than mjMINVAL Object name = arm, id = 1; change or remove what it names");
  const TemporaryFolder folder;
  write_mjcf(folder / "arm.xml", make_hinge_arm(kMjcfBar, "<include file=\"more.xml\"/>"));
  write_mjcf(folder / "more.xml", "<x>\n\n<sensors/>\n</x>");
  try {
    load_urdf(folder / "arm.xml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("/more.xml:3: MuJoCo 2.2.2 does not take the file: XML Error: "
                          "Schema violation: unrecognized element Element 'sensors'"));
  }
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

TEST(MjcfRefusal, OfIncludesThatCannotBeRead) {
  EXPECT_EQ(
      describe_mjcf_refusal("<mujoco>\n<include file=\"gone.xml\"/></mujoco>"),
      "arm.xml:2: <include>: there is no file 'gone.xml'; put it beside the file that includes "
      "it");
  EXPECT_EQ(describe_mjcf_refusal("<mujoco>\n<include/></mujoco>"),
            "arm.xml:2: <include> has no file; it must name one");
  const TemporaryFolder folder;
  write_mjcf(folder / "arm.xml", "<mujoco><include file=\"arm.xml\"/></mujoco>");
  try {
    load_urdf(folder / "arm.xml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a file cannot include itself"));
  }
}

}  // namespace
}  // namespace armwright::physics_test

#else

namespace armwright::physics_test {
namespace {

TEST(Mjcf, NeedsMujoco) {
  EXPECT_EQ(
      describe_mjcf_refusal("<mujoco/>"),
      "arm.xml: is MJCF, which needs the library MuJoCo: install libmujoco-dev and build with "
      "-DARMWRIGHT_WITH_MUJOCO=ON, or use a URDF");
}

}  // namespace
}  // namespace armwright::physics_test

#endif
