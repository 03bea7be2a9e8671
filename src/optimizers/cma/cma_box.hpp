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
//
// The box of a discrete variable reaches half a step further at both ends, so that every value has
// a cell of the same width (of the same ratio if logarithmic, up to the ends). Its u is not bent:
// all u outside [0, 1] mean the outermost values, as cma_margin.hpp expects.
#pragma once

#include <span>
#include <vector>

#include "optimizers/cma/cma_margin.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

double calc_share_in_box(double u);           // in [0, 1]
double calc_preimage_of_share(double share);  // in [-a, 1 + a], for a share in [0, 1]

// The box of a problem in the coordinates of CMA-ES.
class CmaBox {
 public:
  explicit CmaBox(std::span<const DecisionVariable> variables);

  std::size_t dimension() const { return space_.dimension(); }
  bool is_discrete(std::size_t coordinate) const;
  std::vector<double> make_start() const;
  // Returns the u of a share of the box's width, in [0, 1].
  double to_coordinate(std::size_t coordinate, double share) const;
  // Returns a decision vector in the box, whose discrete variables have values of their type.
  std::vector<double> to_point(std::span<const double> u) const;
  // Returns a decision vector's place in the box, as shares of its width, and the u of such shares;
  // shares outside [0, 1] mean the bounds.
  std::vector<double> calc_shares(std::span<const double> point) const;
  std::vector<double> to_coordinates(std::span<const double> shares) const;
  // Returns the cells that contain u, one per coordinate. Those of real variables have no meaning.
  std::vector<CmaCell> calc_cells(std::span<const double> u) const;

 private:
  double calc_share(std::size_t coordinate, double value) const;

  std::vector<DecisionVariable> variables_;
  SearchSpace space_;  // with the wider boxes of discrete variables
};

}  // namespace armwright
