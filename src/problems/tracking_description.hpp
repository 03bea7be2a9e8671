// What a tracking problem offers to an optimizer: which numbers of the design are its variables, in
// what box, and the names and units of its objectives and metrics.
#pragma once

#include "problems/tracking_problem.hpp"

namespace armwright {

// The number of a design that a parameter stands for.
double& get_parameter(ArmDesign& design, const DesignParameter& parameter);

// How long a generated case takes (s), up to the rounding of each move to whole control periods.
double calc_case_duration_s(const TrackingTask& task, const WorkspaceSphere& sphere);

// Whether an evaluation carries the metric: where it counts, so that the records of all other
// problems stay as they were.
bool has_duration_metric(const TrackingConfig& config);

// Error{usage} if a variable has no bounds: it starts at 0, or too near to the ends of the numbers.
ProblemDescription make_tracking_description(const TrackingConfig& config);

}  // namespace armwright
