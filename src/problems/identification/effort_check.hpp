// Checks of recorded efforts that need the robot's model, beside those of problems/logs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "problems/identification/identification_problem.hpp"

namespace armwright {

// Returns what is wrong with the efforts of the fitted and the held-back motions, one sentence each
// with what to do:
//   - efforts of one joint with the opposite sign: their correlation with those of the robot's own
//     model is below -0.5;
//   - efforts of two joints that are swapped: exchanged, the model's error is less than 0.8 of what it
//     is, and less than 0.9 deviations;
//   - two joints that are swapped, positions and efforts: likewise, less than half of what it is.
std::vector<std::string> find_effort_faults(const IdentificationProblem& problem);

}  // namespace armwright
