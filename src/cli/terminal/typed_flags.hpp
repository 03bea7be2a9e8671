// Errors about settings in the words of the command line. A flag such as --tip stands for a setting
// of the problem. The reader of settings knows only the setting and would blame a --set that the
// user has not typed.
#pragma once

#include <span>
#include <string>

namespace armwright {

// Returns the message with the typed flag in place of its setting: "--tip tol: arm.urdf: ..." in
// place of "--set robot.tip=\"tol\": robot.tip is \"tol\"; arm.urdf: ...". If the problem does not
// have the setting, the message says so. Other messages stay as they are.
std::string name_typed_flags(const std::string& message, std::span<const std::string> command_line);

}  // namespace armwright
