// What a tracking problem offers to an optimizer: which numbers of the design are its variables, in
// what box, and the names and units of its objectives and metrics.
#pragma once

#include "problems/tracking/tracking_problem.hpp"

namespace armwright {

// The number of a design that a parameter stands for; of a design with a speed of its own, if it is
// that.
double& get_parameter(ArmDesign& design, const DesignParameter& parameter);

// How long a generated case takes (s), up to the rounding of each move to whole control periods.
// How far the tip moves to each point of a case; nothing of a continuous path, which has no moves.
std::vector<double> list_moves_m(const TrackingConfig& config);
double calc_case_duration_s(const TrackingConfig& config, const TrackingTask& task);

bool is_effort(const DesignParameter& parameter);  // one of the two limits
// The parameter's span: from the start value divided by it to the start value times it.
double get_bounds_factor(const TrackingConfig& config, const DesignParameter& parameter);

// What of the arm or the task depends on the variables.
bool changes_links(const TrackingConfig& config);
bool changes_speed(const TrackingConfig& config);
// Whether an evaluation carries these metrics: where they say something, so that the records of all
// other problems stay as they were.
bool has_duration_metric(const TrackingConfig& config);
bool has_mass_metric(const TrackingConfig& config);

// Error{usage} if a variable has no bounds: it starts at 0, or too near to the ends of the numbers.
ProblemDescription make_tracking_description(const TrackingConfig& config);

}  // namespace armwright
