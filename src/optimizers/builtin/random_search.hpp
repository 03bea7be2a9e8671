// Random search: the start, then independent points that are uniform in the box (uniform in the
// logarithm for a logarithmic variable). Every other optimizer has to be better than this.
#pragma once

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the rows random and start.
std::vector<OptimizerRow> make_random_search_rows();

// Draws a value uniformly between the bounds, on the variable's own scale. It never lies outside
// them.
double draw_coordinate(const DecisionVariable& variable, RandomStream& random);

}  // namespace armwright
