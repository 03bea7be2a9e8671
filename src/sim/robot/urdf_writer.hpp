// Changes the text of a URDF: its effort limits, or what the reader had to repair. Every other byte
// stays as it was.
//
// The text must be one that load_urdf() accepts. This code only finds the elements' places and
// validates nothing.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// The velocity that is written into a new <limit>. URDF requires a velocity there, but a continuous
// joint without <limit> has none. The value is faster than any joint. It is finite because strict
// readers refuse infinity.
inline constexpr double kNoVelocityLimit_rad_per_s = 1e6;

// Returns the text with <limit effort="..."> of some joints replaced. `efforts` has their new
// limits by name, in N m, or in N for a prismatic joint. A joint without <limit> gets one, with
// kNoVelocityLimit_rad_per_s. Inserts `comment` as an XML comment after the XML
// declaration; inserts blanks where the comment's text would end it early. `name` is the file's
// name in messages. Throws Error{bad_data} if a joint does not exist.
std::string set_effort_limits(std::string_view xml, const std::string& name,
                              std::map<std::string, double> efforts, std::string_view comment);

// Returns the text with the edits of the repairs, which load_urdf() reported for the same text. With
// the same options for base and tip, the result is the same robot without any repair. `comment` is
// inserted as set_effort_limits() does.
std::string apply_repairs(std::string_view xml, const std::string& name,
                          std::span<const UrdfRepair> repairs, std::string_view comment);

}  // namespace armwright
