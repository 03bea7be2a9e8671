// The tables [[requirement]] of a tracking problem (requirement.hpp):
//   quantity   one of requirement_table()
//   limit_relative, limit_s, limit_m, limit_n_m, limit_j, limit_rad_per_s; of a joint that slides
//              limit_n or limit_m_per_s: the one of the quantity's unit
//   joint      a joint's name; of peak_torque, rms_torque and joint_speed
//   band_m     of settling_time
//   use        "report" (the default) or "constraint"
#pragma once

#include <span>
#include <vector>

#include "base/config.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {

// For the robot, task, workspace and objective of `config`; a start speed of its own included.
// Error{usage} names file, line and key.
std::vector<Requirement> read_requirements(std::span<const ConfigTable> tables,
                                           const TrackingConfig& config);

}  // namespace armwright
