// Makes a log of the messages of one topic of a bag: sensor_msgs/JointState or
// control_msgs/JointTrajectoryControllerState, in CDR (OMG DDS-XTypes 1.3, 7.4) of either byte order.
//
// A controller's state has several points: the reference (or "desired"), the feedback ("actual"), the
// error, and in newer versions the output. The definition in the bag decides which there are, else
// the length of the message.
#pragma once

#include "problems/logs/bag.hpp"
#include "problems/logs/log_columns.hpp"

namespace armwright {

// Times count from the first message. They are those of the messages' headers, or else those of the
// recorder. Messages without any of the robot's joints are left out.
//
// Throws Error{bad_data} if no topic fits or several do, and for a message that does not have the
// robot's joints with positions and efforts, or is no CDR.
Recording read_bag_log(const Bag& bag, const LogColumns& columns);

}  // namespace armwright
