// Writes a PID design as parameters of ROS 2, for controller_manager and
// joint_trajectory_controller, which commands efforts or velocities through one control_toolbox::Pid
// per joint. A design that commands positions becomes a pid_controller, through which
// joint_trajectory_controller sends its positions.
//
// Our law (sim/controllers/pid.hpp), where h is the control period:
//   u = clamp(p e + i S + d (e - e_prev) / h),  S = sum of e h; S stays as it is for one period
//   after a clamped one.
// The law of ROS 2, where v is a velocity, of the trajectory and of the joint:
//   u = p e + I + d (v_desired - v),  I = sum of i e dt.
// The distributions differ in how they clamp u and limit I:
//   Humble (2.x)             i_clamp limits I to both sides alike; u is not clamped
//   Jazzy (4.27.0 and later) u_clamp_max/min limit u; antiwindup_strategy "conditional_integration"
//                            stops the integration while u is clamped and e would push it further;
//                            i_clamp as in Humble
//   Kilted (5.7.0 and later) as Jazzy, with i_clamp_max/min instead of i_clamp
// With velocities, ff_velocity_scale times the trajectory's velocity is added (pid_drive.hpp).
// pid_controller adds feedforward_gain times the position, in Jazzy only with enable_feedforward,
// and in Humble only after a call of a service.
//
// Sources: joint_trajectory_controller_parameters.yaml, CHANGELOG.rst and documentation of
// ros2_controllers (control.ros.org; pull requests 949, 1759, 1845), control_toolbox's pid.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/tracking/design.hpp"

namespace armwright {

// The way in which a file makes pid_controller add the position itself: by no parameter, by a parameter of its own
// beside the gain, or by the gain alone.
enum class FeedForwardSwitch { none, parameter, gain };

// The parameters that a distribution's controllers have.
struct Ros2Distribution {
  std::string name;           // "humble", part of a file's name
  std::string releases;       // of ros2_controllers, for which the file is right
  bool clamps_output;         // has u_clamp_max, u_clamp_min and antiwindup_strategy
  bool symmetric_integral;    // has i_clamp instead of i_clamp_max and i_clamp_min
  bool has_angle_wraparound;  // needs angle_wraparound, because it does not read it from the URDF
  FeedForwardSwitch feed_forward;
};
std::span<const Ros2Distribution> ros2_distributions();

// Returns whether the distribution has a controller that commands what the design's does.
bool has_interface(const Ros2Distribution& distribution, const ArmDesign& design);

// Returns the file for one distribution. `origin` are lines of text that say where the design comes
// from. Throws Error{usage} if the controller is not "pid", "pid_velocity" or "pid_position", if it
// commands positions and the distribution has no controller for that (has_interface()), if the period
// is not 1 s divided by a whole number, or if a joint has no finite limits of what is commanded, or
// limits that allow nothing.
std::string make_ros2_control(const Ros2Distribution& distribution, const RobotModel& robot,
                              const ArmDesign& design, double control_period_s,
                              std::span<const std::string> origin);

}  // namespace armwright
