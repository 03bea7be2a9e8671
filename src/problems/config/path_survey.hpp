// Checks on some cases whether a robot can follow the paths of a problem, before any of them is
// simulated (sim/tracking/path_check.hpp).
#pragma once

#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"

namespace armwright {

// Returns messages for the user, one line each: the parts of the URDF that are not simulated; and,
// unless task.limits is "ignore", the joint limits that the first cases of the training, validation
// and test sets exceed, the worst per kind of limit and joint. Empty for functions. Throws
// Error{bad_data} if task.limits is "enforce" and a limit is exceeded.
std::vector<std::string> check_paths(const LoadedProblem& problem);

}  // namespace armwright
