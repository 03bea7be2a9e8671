// Latin hypercube sampling: designs of N points in which every variable's range, cut into N equal
// intervals on the variable's own scale, has exactly one point in each of them (McKay, Beckman and
// Conover 1979, A comparison of three methods for selecting values of input variables in the
// analysis of output from a computer code).
#pragma once

#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

std::vector<OptimizerRow> make_latin_hypercube_rows();

// One design, in the coordinates of `space`.
std::vector<std::vector<double>> draw_latin_hypercube(const SearchSpace& space, std::size_t samples,
                                                      RandomStream& random);

}  // namespace armwright
