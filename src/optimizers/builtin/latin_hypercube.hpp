// Latin hypercube sampling. A design of N points divides the range of every variable into N equal
// intervals, on the variable's own scale, and has exactly one point in each interval. Source:
// McKay, Beckman and Conover 1979, A comparison of three methods for selecting values of input
// variables in the analysis of output from a computer code.
#pragma once

#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

// Returns the row lhs.
std::vector<OptimizerRow> make_latin_hypercube_rows();

// Draws one design of `samples` points in the coordinates of `space`.
std::vector<std::vector<double>> draw_latin_hypercube(const SearchSpace& space, std::size_t samples,
                                                      RandomStream& random);

}  // namespace armwright
