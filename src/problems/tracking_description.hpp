// What a tracking problem offers to an optimizer: which numbers of the design are its variables, in
// what box, and the names and units of its objectives and metrics.
#pragma once

#include "problems/tracking_problem.hpp"

namespace armwright {

// The number of a design that a parameter stands for.
double& get_parameter(ArmDesign& design, const DesignParameter& parameter);

// Error{usage} if a variable has no bounds: it starts at 0, or too near to the ends of the numbers.
ProblemDescription make_tracking_description(const TrackingConfig& config);

}  // namespace armwright
