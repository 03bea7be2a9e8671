// Latin hypercube sampling.
#pragma once

#include <vector>

#include "optimizers/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_latin_hypercube_rows();

}  // namespace armwright
