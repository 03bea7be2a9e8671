// Assumes the masses of moving links for which a file has none. Every such link becomes a solid
// cylinder of kRepairDensity_kg_per_m3 from its joint to the next one, or to the tip:
//   length     l_i, the distance between the two; at least d_i
//   diameter   d_i = L/14 (1 + R_i/L), where L is the sum of all distances from the first joint to
//              the tip, and R_i that of the distances from joint i on
// So the arm is L/7 thick where it begins and L/14 at its tip. Source: our own fit to the moving
// masses in public files of 12 arms of 0.4 to 1.7 m, from the SO-100 to the RX160: the rule gives
// 0.37 to 2.4 times the stated mass, in the median as much.
//
// Where the file states effort limits, all assumed masses are reduced by one factor, so that gravity
// takes at most kMostGravityShare of each limit of the arm stretched out horizontally: an arm that
// cannot carry itself is certainly not the real one. Joints whose axis is vertical in every posture
// carry no weight.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Real arms have between 0.25 (iiwa 14) and 0.95 (RX160) in that posture.
inline constexpr double kMostGravityShare = 0.6;

// Gives mass properties to every moving link of mass 0. Returns their indices in `robot.links`. Adds
// notes that state the rule and its results, if there are such links.
std::vector<std::size_t> assume_masses(RobotModel& robot, std::vector<std::string>& notes);

}  // namespace armwright
