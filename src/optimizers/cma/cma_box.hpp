// The map from the unbounded space in which CMA-ES samples to the box. It is smooth: an optimum on
// a bound becomes an ordinary minimum inside. No penalty has to be weighted, and no points
// accumulate on the bounds.
//
// Every coordinate u is a share of the box's width (SearchSpace coordinates). With a = 0.05 the map
// is
//   u                    on [a, 1 - a],
//   (u + a)^2 / (4 a)    on [-a, a], and its mirror image at the other end,
// and beyond [-a, 1 + a] the mirror image of the values inside. The map is continuous with its
// first derivative, reaches all of [0, 1], and is one-to-one on [-a, 1 + a]. Source: Hansen's
// implementations of CMA-ES have such a map (boundary_transformation of c-cmaes, Hansen 2014). The
// width a of the curved end is our choice.
#pragma once

#include <span>
#include <vector>

#include "optimizers/interface/search_space.hpp"

namespace armwright {

double calc_share_in_box(double u);           // in [0, 1]
double calc_preimage_of_share(double share);  // in [-a, 1 + a], for a share in [0, 1]

// The box of a problem in the coordinates of CMA-ES.
class CmaBox {
 public:
  explicit CmaBox(std::span<const DecisionVariable> variables) : space_(variables) {}

  std::size_t dimension() const { return space_.dimension(); }
  std::vector<double> make_start() const;
  std::vector<double> to_point(std::span<const double> u) const;  // a decision vector in the box

 private:
  SearchSpace space_;
};

}  // namespace armwright
