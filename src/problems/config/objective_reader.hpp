// The [objective] table of a tracking problem.
#pragma once

#include "base/config.hpp"
#include "problems/tracking/tracking_problem.hpp"

namespace armwright {

TrackingObjective read_objective(const ConfigTable& table);
// Objectives with a limit of which nothing can come, whatever the design: refused in `table`.
void check_limits(const ConfigTable& table, const TrackingConfig& config);

}  // namespace armwright
