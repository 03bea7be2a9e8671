// The two steps of reading a URDF; internal to the sim room (its door is robot_model.hpp). Each
// confines one XML library.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "sim/robot_model.hpp"

namespace armwright {

inline constexpr std::size_t kUrdfLimit_bytes = std::size_t{8} << 20;

// Validates everything that is used of a URDF (robot_model.hpp says what is refused). Returns the
// same robot as plain XML: only elements and attributes that were checked, every number in its
// shortest exact form, so that a second parser cannot read it differently. Throws Error{bad_data}
// "NAME:LINE: ...".
std::string check_urdf(std::string_view xml, const std::string& name);

// Builds the model from what check_urdf() returned, with urdfdom; lumps links joined by fixed
// joints.
RobotModel build_model(const std::string& checked_xml, const std::string& name);

}  // namespace armwright
