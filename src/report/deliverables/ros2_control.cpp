#include "report/deliverables/ros2_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/formats/export_text.hpp"

namespace armwright {
namespace {

// Returns the text as a comment with lines of at most kColumns characters. In an item ("- ..."),
// the lines after the first are indented.
std::string comment_on(std::string_view text) {
  constexpr std::size_t kColumns = 100;
  std::string lines;
  const std::string_view next = text.starts_with("- ") ? "#  " : "#";
  std::string line = "#";
  for (const std::string& word : split(escape_yaml(text), ' ')) {
    if (line.size() > next.size() && line.size() + 1 + word.size() > kColumns) {
      lines += line + "\n";
      line = next;
    }
    line += " " + word;
  }
  return lines + line + "\n";
}

// Returns the update rate of the controllers. controller_manager wants a whole number.
long calc_update_rate_hz(double period_s) {
  constexpr double kRounding = 1e-9;  // of 1 / h, relative
  const double rate_hz = 1 / period_s;
  const double whole_hz = std::round(rate_hz);
  if (whole_hz < 1 || std::abs(rate_hz - whole_hz) > kRounding * whole_hz) {
    throw Error(
        ErrorKind::usage,
        fmt::format("control.period_s is {}, which is {:.6g} updates a second; the update_rate of "
                    "ROS 2's controller_manager is a whole number: optimize with a period of 1 s "
                    "divided by one, such as --set control.period_s={}",
                    period_s, rate_hz, format_exact(1 / std::max(1.0, whole_hz))));
  }
  return static_cast<long>(whole_hz);
}

void check_pid(const RobotModel& robot, const ArmDesign& design) {
  if (design.controller != "pid") {
    throw Error(
        ErrorKind::usage,
        fmt::format("the winner's controller is '{}', and ROS 2's joint_trajectory_controller has "
                    "nothing but a PID for efforts: optimize with --set control.controller=pid, "
                    "or take the gains from --format datasheet for a controller of your own",
                    design.controller));
  }
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const EffortLimits& limits = design.joints[i].limits;
    if (!(limits.min < limits.max)) {
      throw Error(ErrorKind::usage,
                  fmt::format("{}: the effort limits are {} to {}, which allow no effort; ROS 2 "
                              "wants a lower limit below the upper one",
                              sanitize(robot.joints[i].name), limits.min, limits.max));
    }
  }
}

std::string explain(const Ros2Distribution& distribution) {
  std::string text = comment_on(fmt::format("For {}.", distribution.releases));
  text += comment_on(
      "Parameters and law as in joint_trajectory_controller_parameters.yaml of ros2_controllers "
      "and pid.cpp of control_toolbox (control.ros.org).");
  text += "#\n# How the robot's controller differs from the simulated one:\n";
  text += comment_on(
      "- d acts on the trajectory's velocity less the joint's measured one, where the simulation "
      "has the difference of two errors: the trajectory must bear velocities (or be interpolated "
      "by splines, the default), and the state interface must give a good velocity.");
  if (distribution.clamps_output) {
    text += comment_on(
        "- u_clamp_min and u_clamp_max are the design's effort limits. While a command is clamped "
        "and its error would push it further, nothing is integrated; in the simulation nothing is "
        "integrated for the period after a clamped one, and a period's error is in the integral "
        "at once, here from the next period on.");
  } else {
    text += comment_on(
        "- This release does not clamp a command: the hardware must keep to the effort limits "
        "that stand beside each joint. Nor does it stop the integral while a command is beyond "
        "them: i_clamp limits what the integral contributes, but behind that it goes on growing.");
  }
  text += distribution.symmetric_integral
              ? comment_on(
                    "- i_clamp limits the integral's contribution to either side alike. Where the "
                    "effort limits differ it is the larger one, as the joint may need it to hold "
                    "the arm: to the other side the integral alone can ask for more than the "
                    "limit.")
              : comment_on(
                    "- i_clamp_min and i_clamp_max are the effort limits too: the integral alone "
                    "never asks for more.");
  text += comment_on(
      "- Nothing is added in advance, for gravity or otherwise (ff_velocity_scale is 0): the "
      "hardware must not do so either.");
  if (!distribution.has_angle_wraparound) {
    text += comment_on(
        "- Whether a joint turns without end, and its error goes the short way round, is taken "
        "from the robot_description.");
  }
  return text +
         "#\n# Try it in a simulator and at low speed first. The numbers come from a model.\n";
}

std::string make_joint_gains(const Joint& joint, const JointDrive& drive,
                             const Ros2Distribution& distribution) {
  const bool slides = joint.kind == JointKind::prismatic;
  const auto unit = [&](const char* of_turning) { return get_joint_unit(of_turning, joint.kind); };
  const EffortLimits& limits = drive.limits;
  std::string text =
      fmt::format("      {}:  # {}: p in {}, i in {}, d in {}; effort {:.6g} to {:.6g} {}\n",
                  quote_yaml(joint.name), slides ? "slides" : "turns", unit("N m/rad"),
                  unit("N m/(rad s)"), unit("N m s/rad"), limits.min, limits.max, unit("N m"));
  const auto add = [&](const char* key, double value) {
    text += fmt::format("        {}: {}\n", key, format_yaml(value));
  };
  add("p", drive.gains[0]);
  add("i", drive.gains[1]);
  add("d", drive.gains[2]);
  if (distribution.symmetric_integral) {
    add("i_clamp", calc_largest_effort(drive));
  } else {
    add("i_clamp_max", limits.max);
    add("i_clamp_min", limits.min);
  }
  if (distribution.clamps_output) {
    add("u_clamp_max", limits.max);
    add("u_clamp_min", limits.min);
    text += "        antiwindup_strategy: \"conditional_integration\"\n";
  }
  add("ff_velocity_scale", 0);
  if (distribution.has_angle_wraparound) {
    text += fmt::format("        angle_wraparound: {}\n",
                        !slides && std::isinf(joint.lower) ? "true" : "false");
  }
  return text;
}

}  // namespace

std::span<const Ros2Distribution> ros2_distributions() {
  static const std::array<Ros2Distribution, 3> distributions = {{
      {"humble", "ROS 2 Humble (ros2_controllers 2.x)", false, true, true},
      {"jazzy", "ROS 2 Jazzy (ros2_controllers 4.27.0 of June 2025 and later 4.x)", true, true,
       false},
      {"kilted", "ROS 2 Kilted (ros2_controllers 5.7.0 of September 2025) and later", true, false,
       false},
  }};
  return distributions;
}

std::string make_ros2_control(const Ros2Distribution& distribution, const RobotModel& robot,
                              const ArmDesign& design, double control_period_s,
                              std::span<const std::string> origin) {
  constexpr const char* kController = "joint_trajectory_controller";
  check_pid(robot, design);
  const long rate_hz = calc_update_rate_hz(control_period_s);
  std::string text;
  for (const std::string& line : origin) {
    text += comment_on(line);
  }
  text += "#\n" + explain(distribution);
  text += fmt::format(
      "controller_manager:\n"
      "  ros__parameters:\n"
      "    update_rate: {}  # Hz: the control period of {} s\n"
      "    {}:\n"
      "      type: \"joint_trajectory_controller/JointTrajectoryController\"\n\n",
      rate_hz, format_exact(control_period_s), kController);
  text += fmt::format("{}:\n  ros__parameters:\n    joints:\n", kController);
  for (const Joint& joint : robot.joints) {
    text += fmt::format("      - {}\n", quote_yaml(joint.name));
  }
  text +=
      "    command_interfaces:\n      - \"effort\"\n"
      "    state_interfaces:\n      - \"position\"\n      - \"velocity\"\n"
      "    gains:\n";
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    text += make_joint_gains(robot.joints[i], design.joints[i], distribution);
  }
  return text;
}

}  // namespace armwright
