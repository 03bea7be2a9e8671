// The order of designs with several objectives and constraints that mode and nsga3 share.
//
// Constraint domination (Deb, Pratap, Agarwal and Meyarivan 2002, A fast and elitist multiobjective
// genetic algorithm: NSGA-II, section VI): of two members, the one with the smaller violation
// dominates. Of two members with equal violations (often zero), the one that is nowhere worse and
// somewhere better in the objectives dominates. Objectives are minimised and must not be NaN. A
// failed evaluation has an infinite violation or, without constraints, the penalty of its problem
// as objectives.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace armwright {

struct FrontMember {
  std::vector<double> coordinates;  // search_space.hpp
  std::vector<double> objectives;
  double violation = 0;  // the sum of max(0, g)
};

// Returns whether `a` dominates `b` or has the same violation and objectives.
bool equals_or_dominates(const FrontMember& a, const FrontMember& b);
bool dominates(const FrontMember& a, const FrontMember& b);

// Returns the indices of the members, front by front: the members of a front are dominated by
// members of earlier fronts only. The best front comes first. Within a front the members have the
// order of violation, objectives and index. Cost: at most n^2 comparisons. Source: Zhang, Tian,
// Cheng and Jin 2015, An efficient approach to nondominated sorting for evolutionary multiobjective
// optimization (ENS-SS).
std::vector<std::vector<std::size_t>> sort_into_fronts(std::span<const FrontMember> members);

// Returns the crowding distance of each member of one front, in the order of `front`: the sum over
// the objectives of the distance between its two neighbours, as a share of the front's range. The
// ends of a range have an infinite one. Source: Deb et al. 2002, section III.B.
std::vector<double> calc_crowding(std::span<const FrontMember> members,
                                  std::span<const std::size_t> front);

}  // namespace armwright
