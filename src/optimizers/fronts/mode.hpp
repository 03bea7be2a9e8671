// The steps of mode, multi-objective differential evolution: GDE3 of Kukkonen and Lampinen 2005,
// GDE3: the third evolution step of generalized differential evolution, with DE/rand/1/bin.
//
// In each generation every member gets one trial. The trial takes a coordinate from
// a + F (b - c) with the probability CR, at least one, and the others from the member; a, b and c
// are three other members. A trial that dominates its member, or equals it, replaces it; a trial
// that its member dominates is dropped; otherwise both stay. Then the set is cut to its size by
// non-dominated sorting, and by crowding within the last front. Deviations from the source:
// constraints count as their total violation (front_order.hpp), not one by one; and a coordinate
// outside its bounds is moved to the bound. Reflected coordinates never reach a front that lies on a
// bound: on zdt1 they left ten times the gap in 25,000 evaluations.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/fronts/front_order.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

struct DifferentialSettings {
  double weight = 0;     // F
  double crossover = 0;  // CR
};

// Makes the coordinates of the trial of member `index`. There must be at least four members. A
// coordinate outside its bounds is moved to the nearest one. Draws in this order: three other members,
// the coordinate that is taken in any case, and for each coordinate whether it is taken.
std::vector<double> make_trial(std::span<const FrontMember> members, std::size_t index,
                               const SearchSpace& space, const DifferentialSettings& settings,
                               RandomStream& random);

// Returns the next population: `size` of the members and their trials, which are as many.
std::vector<FrontMember> select_survivors(std::span<const FrontMember> members,
                                          std::span<const FrontMember> trials, std::size_t size);

}  // namespace armwright
