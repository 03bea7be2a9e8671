// Random search: the start, then independent points, uniform over the box (uniform in the logarithm
// for a logarithmic variable). What every other optimizer has to beat.
#pragma once

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_random_search_rows();

// One coordinate: uniform between the bounds on the variable's own scale, never outside them.
double draw_coordinate(const DecisionVariable& variable, RandomStream& random);

}  // namespace armwright
