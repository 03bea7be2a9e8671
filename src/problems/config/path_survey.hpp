// Whether an arm can do what a problem asks of it, looked at on some cases before any of them is
// simulated (sim/path_check.hpp).
#pragma once

#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"

namespace armwright {

// What a user should know of the problem's robot and of its paths, a line each: what of its URDF is
// not simulated; and, where task.limits is not "ignore", what the first cases of the training,
// validation and test sets ask of its joints that they cannot do, the worst of every kind and
// joint. Error{bad_data} where task.limits is "enforce" and there is any of that. Nothing for
// functions.
std::vector<std::string> check_paths(const LoadedProblem& problem);

}  // namespace armwright
