// The coordinates in which optimizers work that know nothing of scales: a linear variable as it is
// (bit for bit, so that a wrapped library asks for the very points it would ask for alone), a
// logarithmic one as the logarithm of its magnitude; the sign is put back.
//
// A factor of ten is 2.3 of these coordinates. A step given as a share of the box means the same on
// either scale: a share of (upper - lower) in these coordinates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "problems/interface/problem.hpp"

namespace armwright {

class SearchSpace {
 public:
  explicit SearchSpace(std::span<const DecisionVariable> variables);

  std::size_t dimension() const { return lower_.size(); }
  const std::vector<double>& lower() const { return lower_; }
  const std::vector<double>& upper() const { return upper_; }
  const std::vector<double>& start() const { return start_; }

  // A decision vector. What lies in the box of these coordinates comes out inside the bounds; what
  // lies outside comes out outside.
  std::vector<double> to_point(std::span<const double> coordinates) const;
  std::vector<double> to_coordinates(std::span<const double> x) const;
  // How fast the point changes with each coordinate: 1, or of a logarithmic variable its value.
  std::vector<double> calc_point_slopes(std::span<const double> coordinates) const;

  // Coordinates drawn uniformly between `lower` and `upper`, one number of the stream each. Those
  // lie in the box but for roundings; what is drawn lies in it.
  std::vector<double> draw_between(std::span<const double> lower, std::span<const double> upper,
                                   RandomStream& random) const;

 private:
  std::vector<DecisionVariable> variables_;
  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<double> start_;
};

}  // namespace armwright
