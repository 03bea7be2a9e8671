// A picture of an arm in characters.
#pragma once

#include <span>
#include <string>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Returns the arm's side view at the joint positions `q`: its joints as numbers from 1 (letters from
// the tenth, + from the 36th), its base as # and its tip as *. The picture's plane is the vertical one in which the
// tip, or else the farthest joint, lies. Each line ends with a line break. At most 16 lines of 56
// characters.
std::string draw_arm(const RobotModel& robot, std::span<const double> q);

}  // namespace armwright
