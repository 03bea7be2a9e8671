// A PID design as parameters of ROS 2: controller_manager and joint_trajectory_controller, which
// commands efforts through one control_toolbox::Pid a joint.
//
// Ours (sim/controllers/pid.hpp), h the control period:
//   u = clamp(p e + i S + d (e - e_prev) / h),  S = sum of e h, which pauses for the period after a
//   clamped one.
// Theirs, v the velocities of trajectory and joint:
//   u = p e + I + d (v_desired - v),  I = sum of i e dt,
// clamped and kept from winding up by what differs from distribution to distribution:
//   Humble (2.x)             i_clamp: I as far as it counts, symmetric; u is not clamped
//   Jazzy (4.27.0 and later) u_clamp_max/min: u; antiwindup_strategy "conditional_integration": no
//                            integration while u is clamped and e pushes it further; i_clamp
//   Kilted (5.7.0 and later) the same, and i_clamp_max/min instead of i_clamp
//
// Sources: joint_trajectory_controller_parameters.yaml, CHANGELOG.rst and documentation of
// ros2_controllers (control.ros.org; pull requests 949, 1759, 1845), control_toolbox's pid.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/tracking/design.hpp"

namespace armwright {

// What a distribution's controller knows of what a design has.
struct Ros2Distribution {
  std::string name;           // "humble", part of a file's name
  std::string releases;       // of ros2_controllers, for which the file is right
  bool clamps_output;         // u_clamp_max, u_clamp_min, antiwindup_strategy
  bool symmetric_integral;    // i_clamp, not i_clamp_max and i_clamp_min
  bool has_angle_wraparound;  // not known from the URDF: angle_wraparound
};
std::span<const Ros2Distribution> ros2_distributions();

struct Ros2ControlInput {
  const RobotModel& robot;
  const ArmDesign& design;
  double control_period_s = 0;
  std::vector<std::string> origin;  // lines that say where the design comes from, printable
};

// Error{usage} for another controller than "pid", a period that is no whole number of updates a
// second, and a joint that may exert no effort at all.
std::string make_ros2_control(const Ros2ControlInput& input, const Ros2Distribution& distribution);

}  // namespace armwright
