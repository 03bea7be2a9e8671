#include "report/deliverables/ros2_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/formats/export_text.hpp"
#include "sim/tracking/arm_drives.hpp"

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

constexpr const char* kTrajectory = "joint_trajectory_controller";
constexpr const char* kPid = "pid_controller";

// Returns the limits of what a joint's controller commands.
EffortLimits get_command_limits(const Joint& joint, const ArmDesign& design, std::size_t i) {
  const ArmDrives drives{.interface = find_controller(design.controller).interface};
  return drives.get_command_limits(joint, design.joints[i].limits);
}

void check_controller(const Ros2Distribution& distribution, const RobotModel& robot,
                      const ArmDesign& design) {
  for (const Joint& joint : robot.joints) {
    if (joint.plant.unactuated) {
      throw Error(ErrorKind::usage,
                  fmt::format("joint '{}' is unactuated, so ROS 2 cannot control it: take the "
                              "gains from --format datasheet",
                              sanitize(joint.name)));
    }
  }
  const ControlInterface interface = find_controller(design.controller).interface;
  if (interface == ControlInterface::effort && design.controller != "pid") {
    throw Error(
        ErrorKind::usage,
        fmt::format("the winner's controller is '{}', and ROS 2's joint_trajectory_controller has "
                    "nothing but a PID for efforts: optimize with --set control.controller=pid, "
                    "or take the gains from --format datasheet for a controller of your own",
                    design.controller));
  }
  if (!has_interface(distribution, design)) {
    throw Error(ErrorKind::usage,
                fmt::format("the pid_controller of {} has no parameter that adds the position "
                            "itself to its command, so it cannot command positions as '{}' does: "
                            "take a later distribution, or optimize with control.interface = "
                            "\"velocity\"",
                            distribution.releases, design.controller));
  }
  for (std::size_t i = 0; i < robot.joint_count() && interface != ControlInterface::position; ++i) {
    const EffortLimits limits = get_command_limits(robot.joints[i], design, i);
    if (!(limits.min < limits.max)) {
      throw Error(ErrorKind::usage,
                  fmt::format("{}: the effort limits are {} to {}, which allow no effort; ROS 2 "
                              "wants a lower limit below the upper one",
                              sanitize(robot.joints[i].name), limits.min, limits.max));
    }
    if (interface == ControlInterface::velocity && std::isinf(limits.max)) {
      throw Error(ErrorKind::usage,
                  fmt::format("{}: the joint has no speed limit, which ROS 2's controller needs to "
                              "limit its integral; give it a velocity in the URDF's <limit>",
                              sanitize(robot.joints[i].name)));
    }
  }
}

std::string explain_drives() {
  return comment_on(
      "- The drives' inner loops were simulated as control.bandwidth_hz and control.delay_s say: "
      "measure both on the robot.");
}

std::string explain_position() {
  return comment_on(
             "- The trajectory goes through pid_controller, which adds a PID to its positions: "
             "load "
             "and activate it before joint_trajectory_controller.") +
         comment_on(
             "- The integral goes on growing if a drive cannot follow; so it does in the "
             "simulation.") +
         explain_drives();
}

std::string explain_head(const Ros2Distribution& distribution, ControlInterface interface) {
  return comment_on(fmt::format("For {}.", distribution.releases)) +
         comment_on(fmt::format("Parameters and law as in {} of ros2_controllers and pid.cpp of "
                                "control_toolbox (control.ros.org).",
                                interface == ControlInterface::position
                                    ? "pid_controller.yaml"
                                    : "joint_trajectory_controller_parameters.yaml")) +
         "#\n# How the robot's controller differs from the simulated one:\n";
}

std::string explain_velocity(const Ros2Distribution& distribution) {
  std::string text = comment_on(
      "- d acts on the trajectory's velocity less the joint's measured one, where the simulation "
      "has the difference of two errors: the trajectory must bear velocities (or be interpolated "
      "by splines, the default), and the state interface must give a good velocity.");
  text += distribution.clamps_output
              ? comment_on(
                    "- u_clamp_min and u_clamp_max are the joints' speed limits. In the simulation "
                    "nothing is integrated for the period after a clamped one.")
              : comment_on(
                    "- This release does not clamp a command: the hardware must keep to the speed "
                    "limits. i_clamp limits what the integral contributes to the speed limit.");
  return text + explain_drives();
}

std::string explain_effort(const Ros2Distribution& distribution) {
  std::string text = comment_on(
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
  return text;
}

std::string explain(const Ros2Distribution& distribution, ControlInterface interface) {
  std::string text = explain_head(distribution, interface);
  switch (interface) {
    case ControlInterface::effort:
      text += explain_effort(distribution);
      break;
    case ControlInterface::velocity:
      text += explain_velocity(distribution);
      break;
    case ControlInterface::position:
      text += explain_position();
      break;
  }
  if (!distribution.has_angle_wraparound && interface != ControlInterface::position) {
    text += comment_on(
        "- Whether a joint turns without end, and its error goes the short way round, is taken "
        "from the robot_description.");
  }
  return text +
         "#\n# Try it in a simulator and at low speed first. The numbers come from a model.\n";
}

std::string make_joint_gains(const Joint& joint, const ArmDesign& design, std::size_t i,
                             const Ros2Distribution& distribution) {
  const JointDrive& drive = design.joints[i];
  const ControllerRow& row = find_controller(design.controller);
  const bool slides = joint.kind == JointKind::prismatic;
  const auto unit = [&](std::string_view of_turning) {
    return get_joint_unit(of_turning, joint.kind);
  };
  const EffortLimits limits = get_command_limits(joint, design, i);
  std::string text =
      fmt::format("      {}:  # {}: p in {}, i in {}, d in {}; effort {:.6g} to {:.6g} {}\n",
                  quote_yaml(joint.name), slides ? "slides" : "turns", unit(row.gains[0].unit),
                  unit(row.gains[1].unit), unit(row.gains[2].unit), drive.limits.min,
                  drive.limits.max, unit("N m"));
  const auto add = [&](const char* key, double value) {
    text += fmt::format("        {}: {}\n", key, format_yaml(value));
  };
  add("p", drive.gains[0]);
  add("i", drive.gains[1]);
  add("d", drive.gains[2]);
  const bool ends = !slides && std::isinf(joint.lower);
  if (row.interface == ControlInterface::position) {
    add("feedforward_gain", 1);
    return text +
           fmt::format("        antiwindup_strategy: \"none\"\n        angle_wraparound: {}\n",
                       ends ? "true" : "false");
  }
  if (distribution.symmetric_integral) {
    add("i_clamp", std::max(-limits.min, limits.max));
  } else {
    add("i_clamp_max", limits.max);
    add("i_clamp_min", limits.min);
  }
  if (distribution.clamps_output) {
    add("u_clamp_max", limits.max);
    add("u_clamp_min", limits.min);
    text += "        antiwindup_strategy: \"conditional_integration\"\n";
  }
  add("ff_velocity_scale", row.interface == ControlInterface::velocity ? drive.gains[3] : 0);
  if (distribution.has_angle_wraparound) {
    text += fmt::format("        angle_wraparound: {}\n", ends ? "true" : "false");
  }
  return text;
}

}  // namespace

std::span<const Ros2Distribution> ros2_distributions() {
  static const std::array<Ros2Distribution, 3> distributions = {{
      {"humble", "ROS 2 Humble (ros2_controllers 2.x)", false, true, true, FeedForwardSwitch::none},
      {"jazzy", "ROS 2 Jazzy (ros2_controllers 4.27.0 of June 2025 and later 4.x)", true, true,
       false, FeedForwardSwitch::parameter},
      {"kilted", "ROS 2 Kilted (ros2_controllers 5.7.0 of September 2025) and later", true, false,
       false, FeedForwardSwitch::gain},
  }};
  return distributions;
}

bool has_interface(const Ros2Distribution& distribution, const ArmDesign& design) {
  return find_controller(design.controller).interface != ControlInterface::position ||
         distribution.feed_forward != FeedForwardSwitch::none;
}

std::string make_ros2_control(const Ros2Distribution& distribution, const RobotModel& robot,
                              const ArmDesign& design, double control_period_s,
                              std::span<const std::string> origin) {
  const ControlInterface interface = find_controller(design.controller).interface;
  const bool chained = interface == ControlInterface::position;
  check_controller(distribution, robot, design);
  const long rate_hz = calc_update_rate_hz(control_period_s);
  std::string text;
  for (const std::string& line : origin) {
    text += comment_on(line);
  }
  text += "#\n" + explain(distribution, interface);
  text += fmt::format(
      "controller_manager:\n"
      "  ros__parameters:\n"
      "    update_rate: {}  # Hz: the control period of {} s\n"
      "    {}:\n"
      "      type: \"joint_trajectory_controller/JointTrajectoryController\"\n{}\n",
      rate_hz, format_exact(control_period_s), kTrajectory,
      chained ? fmt::format("    {}:\n      type: \"pid_controller/PidController\"\n", kPid) : "");
  const auto add_joints = [&](const char* key, const std::string& before) {
    text += fmt::format("    {}:\n", key);
    for (const Joint& joint : robot.joints) {
      text += fmt::format("      - {}\n", quote_yaml(before + joint.name));
    }
  };
  text += fmt::format("{}:\n  ros__parameters:\n", kTrajectory);
  add_joints("joints", "");
  if (chained) {
    add_joints("command_joints", std::string(kPid) + "/");
  }
  text += fmt::format(
      "    command_interfaces:\n      - \"{}\"\n"
      "    state_interfaces:\n      - \"position\"\n      - \"velocity\"\n",
      control_interface_names()[static_cast<std::size_t>(interface)]);
  if (chained) {
    text += fmt::format("\n{}:\n  ros__parameters:\n", kPid);
    add_joints("dof_names", "");
    text +=
        "    command_interface: \"position\"\n"
        "    reference_and_state_interfaces:\n      - \"position\"\n";
    if (distribution.feed_forward == FeedForwardSwitch::parameter) {
      text += "    enable_feedforward: true\n";
    }
  }
  text += "    gains:\n";
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    text += make_joint_gains(robot.joints[i], design, i, distribution);
  }
  return text;
}

}  // namespace armwright
