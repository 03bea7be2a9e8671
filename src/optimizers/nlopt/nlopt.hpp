// The gradient-free algorithms of NLopt.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_nlopt_rows();

}  // namespace armwright
