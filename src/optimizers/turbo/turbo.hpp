// The optimizer turbo: Bayesian optimization with Gaussian processes in a trust region
// (turbo_region.hpp), for problems whose evaluations are so expensive that there are only a few
// hundred. When a region has converged, the search restarts: it forgets the region's evaluations and
// begins a new region with a new Latin hypercube. The first one contains the problem's start.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the row turbo.
std::vector<OptimizerRow> make_turbo_rows();

}  // namespace armwright
