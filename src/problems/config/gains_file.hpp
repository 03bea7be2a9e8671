// Reads the gains of a ros2_control controller as a start design. The file has the parameters of a
// joint_trajectory_controller or pid_controller in YAML, as controller_manager loads them:
//   NAME: ros__parameters: gains: JOINT: {p: 5.0, i: 0.1, d: 0.0, ff_velocity_scale: 1.0}
// Other controllers in the file are ignored. Keys may also be joined by dots.
#pragma once

#include <filesystem>
#include <string_view>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/arm_drives.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {

// Returns whether the name of a start is that of a gains file: it ends in .yaml or .yml.
bool is_gains_file(std::string_view name);

// Returns the design. Its controller is "pid", "pid_velocity" or "pid_position", as the drives take
// it. Its effort limits are u_clamp_min and u_clamp_max if the controller commands efforts and has
// both, otherwise those of the robot.
//
// Throws Error{io} if the file cannot be read. Throws Error{bad_data} "FILE:LINE: what, what to do"
// for
// - more than 1 MiB, more than 32 levels, more than 20 000 values, several documents, aliases, a key that stands twice, and
//   what is not YAML,
// - no controller with gains, gains of other joints than the robot's, and several such controllers,
// - command interfaces that differ from that of the drives,
// - gains that are not finite or below 0, and feed-forward that the controller here does not have.
ArmDesign load_gains(const std::filesystem::path& file, const RobotModel& robot,
                     const ArmDrives& drives);
// Does the same for the text of a file; `name` is the file's name in messages.
ArmDesign parse_gains(std::string_view text, const std::string& name, const RobotModel& robot,
                      const ArmDrives& drives);

}  // namespace armwright
