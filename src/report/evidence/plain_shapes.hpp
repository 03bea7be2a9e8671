// Something to look at for a robot whose description does not say what it looks like.
#pragma once

#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Simple shapes of each body, the base first: a tube with round ends from a joint to the next one
// or the tip, a drum around the axis of a revolute joint, a rod along that of a prismatic one.
// Their thickness follows from the chain's length and gets less towards the tip.
std::vector<std::vector<VisualShape>> make_plain_shapes(const RobotModel& model);

}  // namespace armwright
