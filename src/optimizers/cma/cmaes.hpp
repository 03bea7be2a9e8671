// The covariance matrix adaptation evolution strategy with active update, bounds, restarts and,
// on request, handling of noise. The search distribution: cma_distribution.hpp; the box:
// cma_box.hpp; the end of a run: cma_termination.hpp; noise: cma_uncertainty.hpp.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_cmaes_rows();

}  // namespace armwright
