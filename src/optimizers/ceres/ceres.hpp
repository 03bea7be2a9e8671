// Ceres Solver's Levenberg-Marquardt and BFGS, on differences.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_ceres_rows();

}  // namespace armwright
