// Which numbers of the design a [variables] table declares as decision variables.
#pragma once

#include <vector>

#include "base/config.hpp"
#include "problems/tracking_problem.hpp"

namespace armwright {

// The controller's gains by name ("p", "i", "d") or all of them ("gains"), "effort_min" and
// "effort_max", for every joint or for those with a [[variables.joint]] of their own.
std::vector<DesignParameter> read_parameters(const ConfigTable& table,
                                             const TrackingConfig& config);

}  // namespace armwright
