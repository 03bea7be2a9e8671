// The steps of nsga3, a genetic algorithm for three and more objectives: NSGA-III of Deb and Jain
// 2014, An evolutionary many-objective optimization algorithm using reference-point-based
// nondominated sorting approach, part I; constraints as in part II by Jain and Deb.
//
// Parents and children are sorted into fronts. Whole fronts survive as long as there is room. Of the
// front that is cut, those members survive whose reference directions have the fewest members so
// far (niching). Limits: the directions have one layer. With more than five objectives, few
// divisions lie on the edges of the front only; the second layer of the source does not exist here.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/fronts/front_order.hpp"
#include "optimizers/fronts/reference_directions.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

struct GeneticSettings {
  double crossover = 0;        // probability that a pair is crossed
  double crossover_index = 0;  // of SBX; the higher, the nearer children are to their parents
  double mutation_index = 0;   // of polynomial mutation, likewise
};

// Crosses two members by simulated binary crossover within the bounds (Deb and Agrawal 1995,
// Simulated binary crossover for continuous search space) and mutates each coordinate of the two
// children with the probability 1 / n by polynomial mutation (Deb and Goyal 1996). Draws in this
// order: whether the pair is crossed; then for each coordinate, if so, whether it is crossed, the
// spread, and whether the children swap it; then for each child and coordinate whether it is mutated
// and, if so, how far.
std::vector<std::vector<double>> breed_pair(const FrontMember& first, const FrontMember& second,
                                            const SearchSpace& space,
                                            const GeneticSettings& settings, RandomStream& random);

// Returns `size` of the members. Updates the scale. Draws a direction, and a member, wherever
// several are equally good.
std::vector<FrontMember> select_along_directions(std::vector<FrontMember> members, std::size_t size,
                                                 std::span<const std::vector<double>> directions,
                                                 FrontScale& scale, RandomStream& random);

}  // namespace armwright
