// A URDF with other effort limits, and every other byte as it was: comments, extensions, links and
// joints that are not of the chain, how numbers are written.
//
// Only what load_urdf() accepts may be given: here nothing but the places of elements is looked at.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace armwright {

struct JointEffort {
  std::string joint;
  double effort = 0;  // N m, or N of a joint that slides
};

// URDF asks for a velocity in every <limit>; a continuous joint without <limit> has none to give.
// Faster than any joint, and what strict readers take for a number, which infinity is not.
inline constexpr double kNoVelocityLimit_rad_per_s = 1e6;

// Sets <limit effort="..."> of these joints; a joint without <limit> gets one, with
// kNoVelocityLimit_rad_per_s. `comment` is put at the beginning, behind the XML declaration; what
// would end it early is told apart by blanks. `name` is the file's in messages. Error{bad_data} if
// a joint is not there.
std::string set_effort_limits(std::string_view xml, const std::string& name,
                              std::span<const JointEffort> efforts, std::string_view comment);

}  // namespace armwright
