// Which numbers of the design a [variables] table declares as decision variables.
#pragma once

#include <vector>

#include "base/config.hpp"
#include "problems/tracking/tracking_problem.hpp"

namespace armwright {

// The controller's gains by name ("p", "i", "d") or all of them ("gains"), "effort_min",
// "effort_max", "length_scale", "section_scale", for every joint or for those with a
// [[variables.joint]] of their own; without any `optimize` the controllers and limits. Of the whole
// arm, last: task = ["speed"].
std::vector<DesignParameter> read_parameters(const ConfigTable& table,
                                             const TrackingConfig& config);

}  // namespace armwright
