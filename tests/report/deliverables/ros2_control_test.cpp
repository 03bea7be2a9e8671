// Checks the YAML for robots that no other test has: with prismatic joints, joints without position
// limits, and different effort limits. tests/e2e/deliverables_test.cpp checks with a strict reader
// that the file is YAML in the form that ROS 2 wants.

#include "report/deliverables/ros2_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/error.hpp"
#include "report/deliverables/deliverables.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Ros2Control : public testing::Test {
 protected:
  Ros2Control() {
    Joint rail;
    rail.name = "rail";
    rail.kind = JointKind::prismatic;
    rail.upper = 1.5;
    Joint turret;
    turret.name = "turret";
    turret.lower = -std::numeric_limits<double>::infinity();
    turret.upper = std::numeric_limits<double>::infinity();
    Joint elbow;
    elbow.name = "elbow";
    elbow.upper = 2;
    robot_.joints = {rail, turret, elbow};
    design_.joints = {{{1, 2, 3}, {-4, 5}}, {{0.5, 0, 0}, {-7, 6}}, {{9, 8, 7}, {0, 3}}};
  }

  std::string make(std::size_t distribution) const {
    return make_ros2_control(ros2_distributions()[distribution], robot_, design_, period_s_,
                             std::vector<std::string>{"Origin of it"});
  }
  void expect_refused(const testing::Matcher<std::string>& message) const {
    for (std::size_t i = 0; i < ros2_distributions().size(); ++i) {
      try {
        make(i);
        ADD_FAILURE() << "not refused";
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_THAT(std::string(error.what()), message);
      }
    }
  }

  RobotModel robot_;
  ArmDesign design_;
  double period_s_ = 0.01;
};

constexpr std::size_t kHumble = 0, kJazzy = 1, kKilted = 2;

TEST_F(Ros2Control, HumbleHasOneClampOfTheLargerLimitAndIsToldOfJointsWithoutEnd) {
  const std::string text = make(kHumble);
  EXPECT_THAT(text, HasSubstr("\n      \"rail\":  # slides: p in N/m, i in N/(m s), d in N s/m; "
                              "effort -4 to 5 N\n"
                              "        p: 1.0\n        i: 2.0\n        d: 3.0\n"
                              "        i_clamp: 5.0\n        ff_velocity_scale: 0.0\n"
                              "        angle_wraparound: false\n"));
  EXPECT_THAT(text,
              HasSubstr("\n      \"turret\":  # turns: p in N m/rad, i in N m/(rad s), d in N "
                        "m s/rad; effort -7 to 6 N m\n"
                        "        p: 0.5\n        i: 0.0\n        d: 0.0\n"
                        "        i_clamp: 7.0\n        ff_velocity_scale: 0.0\n"
                        "        angle_wraparound: true\n"));
  EXPECT_THAT(text, HasSubstr("        i_clamp: 3.0\n        ff_velocity_scale: 0.0\n"
                              "        angle_wraparound: false\n"));
  EXPECT_THAT(text, AllOf(HasSubstr("does not clamp a command"), Not(HasSubstr("u_clamp_max:")),
                          Not(HasSubstr("antiwindup_strategy:"))));
}

TEST_F(Ros2Control, JazzyClampsTheCommandAsWell) {
  const std::string text = make(kJazzy);
  EXPECT_THAT(text, HasSubstr("        i_clamp: 7.0\n"
                              "        u_clamp_max: 6.0\n        u_clamp_min: -7.0\n"
                              "        antiwindup_strategy: \"conditional_integration\"\n"));
  EXPECT_THAT(text, AllOf(Not(HasSubstr("angle_wraparound")), Not(HasSubstr("i_clamp_max"))));
}

TEST_F(Ros2Control, KiltedHasBothLimitsOfTheIntegral) {
  const std::string text = make(kKilted);
  EXPECT_THAT(text, HasSubstr("        i_clamp_max: 3.0\n        i_clamp_min: 0.0\n"
                              "        u_clamp_max: 3.0\n        u_clamp_min: 0.0\n"));
  EXPECT_THAT(text, Not(HasSubstr("        i_clamp: ")));
}

TEST_F(Ros2Control, AVelocityIsClampedToTheSpeedLimits) {
  design_.controller = "pid_velocity";
  for (std::size_t i = 0; i < 3; ++i) {
    robot_.joints[i].speed_limit = 0.5 + static_cast<double>(i);
    design_.joints[i].gains.push_back(0.9);
  }
  const std::string text = make(kJazzy);
  EXPECT_THAT(text,
              AllOf(HasSubstr("    command_interfaces:\n      - \"velocity\"\n"),
                    HasSubstr("\"rail\":  # slides: p in 1/s, i in 1/s^2, d in 1; effort -4 to "
                              "5 N\n"),
                    HasSubstr("        i_clamp: 1.5\n        u_clamp_max: 1.5\n"
                              "        u_clamp_min: -1.5\n"),
                    HasSubstr("ff_velocity_scale: 0.9\n")));
  robot_.joints[2].speed_limit = std::numeric_limits<double>::infinity();
  expect_refused(AllOf(HasSubstr("elbow: the joint has no speed limit"), HasSubstr("<limit>")));
}

TEST_F(Ros2Control, APositionGoesThroughAPidController) {
  design_.controller = "pid_position";
  const std::string jazzy = make(kJazzy);
  EXPECT_THAT(jazzy,
              AllOf(HasSubstr("    command_joints:\n      - \"pid_controller/rail\"\n"),
                    HasSubstr("    command_interface: \"position\"\n"),
                    HasSubstr("    enable_feedforward: true\n"),
                    HasSubstr("        feedforward_gain: 1.0\n"),
                    HasSubstr("        angle_wraparound: true\n"), Not(HasSubstr("i_clamp:"))));
  EXPECT_THAT(make(kKilted), Not(HasSubstr("enable_feedforward")));
  EXPECT_FALSE(has_interface(ros2_distributions()[kHumble], design_));
  try {
    make(kHumble);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("ROS 2 Humble"), HasSubstr("cannot command positions"),
                      HasSubstr("control.interface")));
  }
}

TEST_F(Ros2Control, TheUpdateRateIsThePeriodsInverse) {
  for (const auto& [period_s, line] :
       {std::pair{0.01, "    update_rate: 100 "}, std::pair{0.001, "    update_rate: 1000 "},
        std::pair{1.0 / 3, "    update_rate: 3 "}}) {
    period_s_ = period_s;
    EXPECT_THAT(make(kJazzy), HasSubstr(line));
  }
}

TEST_F(Ros2Control, NoNameEndsAComment) {
  const std::string text =
      make_ros2_control(ros2_distributions()[kJazzy], robot_, design_, period_s_,
                        std::vector<std::string>{"a\u2028controller_manager: \nx"});
  EXPECT_THAT(text, HasSubstr("# a?controller_manager: ?"));
}

TEST_F(Ros2Control, RefusesWhatItCannotSay) {
  design_.controller = "pid_gravity";
  expect_refused(AllOf(HasSubstr("'pid_gravity'"), HasSubstr("--set control.controller=pid")));
  design_.controller = "pid";
  period_s_ = 0.003;
  expect_refused(AllOf(HasSubstr("control.period_s is 0.003"), HasSubstr("333.333"),
                       HasSubstr("control.period_s=0.003003003003003003")));
  period_s_ = 3;
  expect_refused(HasSubstr("control.period_s=1"));
  period_s_ = 0.01;
  design_.joints[2].limits = {0, 0};
  expect_refused(AllOf(HasSubstr("elbow"), HasSubstr("allow no effort")));
}

TEST(JointUnit, OfAJointThatSlidesIsThatOfAForce) {
  EXPECT_EQ(get_joint_unit("N m/(rad s^2)", JointKind::prismatic), "N/(m s^2)");
  EXPECT_EQ(get_joint_unit("N m s/rad", JointKind::prismatic), "N s/m");
  EXPECT_EQ(get_joint_unit("1/s", JointKind::prismatic), "1/s");
  EXPECT_EQ(get_joint_unit("N m s/rad", JointKind::revolute), "N m s/rad");
}

}  // namespace
}  // namespace armwright
