// Covariance matrix adaptation evolution strategy.
#pragma once

#include <vector>

#include "optimizers/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_cmaes_rows();

}  // namespace armwright
