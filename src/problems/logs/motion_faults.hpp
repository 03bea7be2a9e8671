// Finds what in a log cannot be the motion of the robot: wrong units, swapped columns, clipped
// efforts. log_check.hpp lists the faults.
#pragma once

#include "problems/logs/recording.hpp"

namespace armwright {

// Returns one sentence per fault. `recording` has the names of the columns, `log` their numbers; the
// function adds a note to the log if some joints rest. Throws Error{bad_data} if all joints rest.
std::vector<std::string> find_motion_faults(const Recording& recording, const RobotModel& robot,
                                            MotionLog& log, double period_s);

}  // namespace armwright
