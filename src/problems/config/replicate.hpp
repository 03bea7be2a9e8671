// A problem as one replicate of a comparison meets it: the same problem with other training cases
// and another place to start from. Everything that decides what a solution is worth stays.
#pragma once

#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"

namespace armwright {

// `training_set` is "train/NAME"; `start` has one value a variable, within the bounds. What is
// changed stands in the resolved configuration ("sets.training", "replicate.start").
LoadedProblem make_replicate(const LoadedProblem& problem, const std::string& training_set,
                             const std::vector<double>& start);

}  // namespace armwright
