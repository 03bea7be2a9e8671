// Gains of ros2_control as a start: what is read, and the message for each fault of a file.
#include "problems/config/gains_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "base/error.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kVelocity = R"(controller_manager:
  ros__parameters:
    update_rate: 500
arm:
  arm_controller:
    ros__parameters:
      joints: [base, elbow]
      command_interfaces:
        - velocity
      gains:
        base: {p: 5.0, i: 0.5, d: 0.25, i_clamp: 1.0, ff_velocity_scale: 0.9}
        elbow:
          p: 8
          i: 1e-1
          d: 0.0
gripper:
  ros__parameters:
    joint: finger
    gains.finger.p: 3.0
)";

class Gains : public testing::Test {
 protected:
  Gains() {
    Joint base;
    base.name = "base";
    base.effort_limit = 40;
    Joint elbow = base;
    elbow.name = "elbow";
    elbow.effort_limit = 30;
    robot_.joints = {base, elbow};
    drives_.interface = ControlInterface::velocity;
  }
  ArmDesign parse(const std::string& text) const {
    return parse_gains(text, "arm.yaml", robot_, drives_);
  }
  std::string refusal_of(const std::string& text) const {
    try {
      parse(text);
      return "not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      return error.what();
    }
  }
  std::string refusal_of(const std::string& from, const std::string& to) const {
    std::string text = kVelocity;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return refusal_of(text.replace(at, from.size(), to));
  }

  RobotModel robot_;
  ArmDrives drives_;
};

TEST_F(Gains, OfATrajectoryControllerAreRead) {
  const ArmDesign design = parse(kVelocity);
  EXPECT_EQ(design.controller, "pid_velocity");
  ASSERT_EQ(design.joints.size(), 2U);
  EXPECT_EQ(design.joints[0].gains, (std::vector<double>{5, 0.5, 0.25, 0.9}));
  EXPECT_EQ(design.joints[1].gains, (std::vector<double>{8, 0.1, 0, 0}));
  EXPECT_EQ(design.joints[1].limits.min, -30);
  EXPECT_EQ(design.joints[1].limits.max, 30);
}

TEST_F(Gains, OfEffortsBringTheirLimits) {
  drives_.interface = ControlInterface::effort;
  std::string text = kVelocity;
  text.replace(text.find("- velocity"), 10, "- effort");
  EXPECT_THAT(refusal_of(text),
              HasSubstr("arm.yaml:11: ff_velocity_scale of joint 'base' is 0.9; "));
  text.replace(text.find("ff_velocity_scale: 0.9"), 22, "u_clamp_max: 20, u_clamp_min: -10");
  const ArmDesign design = parse(text);
  EXPECT_EQ(design.controller, "pid");
  EXPECT_EQ(design.joints[0].gains, (std::vector<double>{5, 0.5, 0.25}));
  EXPECT_EQ(design.joints[0].limits.min, -10);
  EXPECT_EQ(design.joints[0].limits.max, 20);
  EXPECT_EQ(design.joints[1].limits.max, 30);
}

TEST_F(Gains, OfPositionsNeedAPidController) {
  drives_.interface = ControlInterface::position;
  EXPECT_THAT(refusal_of("- velocity", "- position"),
              AllOf(HasSubstr("arm.yaml:9: controller 'arm.arm_controller' passes positions on"),
                    HasSubstr("pid_controller")));
  const std::string text = R"(pid:
  ros__parameters:
    command_interface: position
    gains:
      base: {p: 0.1, i: 2.0, d: 0.01, feedforward_gain: 1.0}
      elbow: {p: 0.2, i: 3.0, d: 0.02, feedforward_gain: 1.0}
)";
  EXPECT_EQ(parse(text).controller, "pid_position");
  EXPECT_EQ(parse(text).joints[1].gains, (std::vector<double>{0.2, 3, 0.02}));
  EXPECT_THAT(refusal_of(std::string(text).replace(text.find("gain: 1.0"), 9, "gain: 0.5")),
              HasSubstr("arm.yaml:5: feedforward_gain of joint 'base' is 0.5; "));
}

TEST_F(Gains, OfOtherJointsAreRefused) {
  EXPECT_EQ(
      refusal_of("        elbow:\n", "        wrist:\n"),
      "arm.yaml:13: the gains of controller 'arm.arm_controller' are those of the joints base, "
      "wrist, but the robot's are base, elbow; name a file for this robot, or another "
      "robot.base or robot.tip");
  robot_.joints.pop_back();
  EXPECT_THAT(refusal_of(kVelocity), HasSubstr("arm.yaml:13: the gains of controller"));
  EXPECT_THAT(refusal_of("a: 1\n"), HasSubstr("it has no gains of a controller"));
  EXPECT_THAT(refusal_of(""), HasSubstr("it has no gains of a controller"));
}

TEST_F(Gains, OfAnotherInterfaceAreRefused) {
  EXPECT_EQ(
      refusal_of("- velocity", "- effort"),
      "arm.yaml:9: controller 'arm.arm_controller' commands 'effort', but control.interface is "
      "'velocity'; set control.interface, or name another file");
  EXPECT_THAT(refusal_of("        - velocity", "        - velocity\n        - position"),
              HasSubstr("arm.yaml:10: controller 'arm.arm_controller' has several command"));
}

TEST_F(Gains, MustBeNumbers) {
  EXPECT_EQ(refusal_of("p: 5.0", "p: five"),
            "arm.yaml:11: p of joint 'base' is 'five'; it must be a finite number");
  EXPECT_THAT(refusal_of("p: 5.0", "p: -5.0"), HasSubstr("is -5; it must not be below 0"));
  EXPECT_THAT(refusal_of("p: 5.0", "p: .inf"), HasSubstr("it must be a finite number"));
  robot_.joints[0].effort_limit = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of(kVelocity),
              HasSubstr("arm.yaml:11: the effort limits of joint 'base' are -inf to inf"));
}

TEST_F(Gains, AreReadFromSimpleYamlAlone) {
  EXPECT_THAT(refusal_of("p: 5.0, i", "p: 5.0, p: 6.0, i"),
              HasSubstr("'arm.arm_controller.ros__parameters.gains.base.p' stands there twice"));
  EXPECT_THAT(refusal_of("{p: 5.0", "&x {p: 5.0") + refusal_of("i: 1e-1", "i: *x"),
              HasSubstr("arm.yaml:14: an alias (*NAME); write the values out"));
  EXPECT_THAT(refusal_of("[base, elbow]", "[base, elbow"), HasSubstr("it is not YAML: "));
  EXPECT_THAT(refusal_of(std::string(kVelocity) + "---\nb: 1\n"),
              HasSubstr("a second document begins"));
  EXPECT_THAT(refusal_of("? [a]\n: b\n"), HasSubstr("a key is a list or a map"));
  EXPECT_THAT(refusal_of(std::string(40, '[') + std::string(40, ']')),
              HasSubstr("nested deeper than 32 levels"));
  EXPECT_THAT(refusal_of("a\x01: 1\n"), HasSubstr("arm.yaml:1: it is not YAML"));
}

TEST_F(Gains, OfTwoControllersForTheRobotAreRefused) {
  const std::string one = kVelocity;
  std::string other = one.substr(one.find("  arm_controller"));
  other = other.substr(0, other.find("gripper"));
  std::string text = one;
  text.insert(text.find("gripper"), "brm:\n" + other);
  EXPECT_THAT(refusal_of(text),
              HasSubstr("the controllers arm.arm_controller, brm.arm_controller all have gains"));
}

TEST(GainsFile, IsKnownByItsName) {
  EXPECT_TRUE(is_gains_file("a/controllers.yaml"));
  EXPECT_TRUE(is_gains_file("controllers.yml"));
  EXPECT_FALSE(is_gains_file("controllers.toml"));
  EXPECT_FALSE(is_gains_file("yaml"));
}

}  // namespace
}  // namespace armwright
