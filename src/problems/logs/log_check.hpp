// Checks whether the numbers of a recording can be what they are taken for. No check needs a model
// of the arm's dynamics; the robot gives only the kinds and ranges of its joints.
#pragma once

#include "problems/logs/recording.hpp"

namespace armwright {

// Makes a log of a recording. A column without any number counts as missing, unless it has positions
// or efforts.
//
// Throws Error{bad_data} for
// - fewer than 50 samples, times that repeat, go back or jump by more than 5 periods, and less than
//   10 samples per second,
// - fields without a finite number,
// - positions that look like degrees, and positions outside the joint's range,
// - rates that do not match the positions: swapped columns, a wrong sign or unit,
// - references that match the positions of another joint,
// - efforts that stay exactly at their extreme value while the joint moves (clipped),
// - link positions that are further from the motor's than a gear yields,
// - a robot at rest. If only some joints rest, a note names them.
// The message names the column, the rows, the value and the way to say it right. Several faults of
// the last six kinds are listed together.
MotionLog check_recording(Recording recording, const RobotModel& robot);

}  // namespace armwright
