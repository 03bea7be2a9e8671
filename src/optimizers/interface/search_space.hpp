// The coordinates for optimizers that do not handle scales. A linear variable stays as it is, bit
// for bit, so that a wrapped library evaluates the same points as it does alone. A logarithmic
// variable becomes the logarithm of its magnitude; to_point() restores the sign.
//
// A factor of ten is 2.3 in these coordinates. A step that is a share of the box means the same on
// both scales: a share of (upper - lower) in these coordinates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "problems/interface/problem.hpp"

namespace armwright {

class SearchSpace {
 public:
  explicit SearchSpace(std::span<const DecisionVariable> variables);

  std::size_t dimension() const { return lower_.size(); }
  const std::vector<double>& lower() const { return lower_; }
  const std::vector<double>& upper() const { return upper_; }
  const std::vector<double>& start() const { return start_; }

  // Returns the decision vector. Coordinates inside their box give a point inside the bounds;
  // coordinates outside give a point outside.
  std::vector<double> to_point(std::span<const double> coordinates) const;
  std::vector<double> to_coordinates(std::span<const double> x) const;
  // Returns the derivative of each variable with respect to its coordinate: 1 for a linear
  // variable, the value of the variable for a logarithmic one.
  std::vector<double> calc_point_slopes(std::span<const double> coordinates) const;

  // Draws coordinates uniformly between `lower` and `upper`; each takes one number of the stream.
  // `lower` and `upper` lie in the box except for rounding. The result always lies in the box.
  std::vector<double> draw_between(std::span<const double> lower, std::span<const double> upper,
                                   RandomStream& random) const;
  // Returns a first population: the start, and points that are uniform in a box around it. That box
  // has `spread` times the size of the whole box and is cut at the bounds. `size` is at least 1.
  std::vector<std::vector<double>> draw_population(std::size_t size, double spread,
                                                   RandomStream& random) const;

 private:
  std::vector<DecisionVariable> variables_;
  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<double> start_;
};

// Returns the option for the spread of draw_population().
OptionSpec make_spread_option();

}  // namespace armwright
