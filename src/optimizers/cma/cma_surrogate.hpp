// The model of the objective that saves evaluations of CMA-ES: a polynomial of degree one or two
// for the whole region of the last points, whose ranking stands for that of the objective while
// both agree. Source: Hansen 2019, A Global Surrogate Assisted CMA-ES (GECCO 2019,
// doi:10.1145/3321707.3321842), lq-CMA-ES.
//
//   terms      1, x_i            linear      1 + n coefficients
//              and x_i^2         diagonal    1 + 2 n
//              and x_i x_j       full        1 + n (n + 3) / 2
//
// The largest model is fitted for which 3/4 of the points are at least 1.1 times its coefficients.
// The model has the last max(lambda, n (n + 3) + 2) points, and is fitted to the best 3/4 of them
// by weighted least squares. Their weights fall linearly with the rank, from 20 for the best point
// to 1 for the worst; each multiplies the residual of its point. With fewer points than
// coefficients the solution is the one of least norm.
//
// Deviations: the linear and the diagonal model have the coordinates of the problem, scaled by the
// distribution's deviations; the full one has the coordinates in which the distribution is the
// standard normal one. Both change only rounding errors and the choice among several solutions.
// The minimum of the model is sought within a ball of these coordinates, not everywhere.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "optimizers/cma/cma_distribution.hpp"

namespace armwright {

// Returns Kendall's rank correlation: the number of pairs that both lists order alike, minus the
// number of those that they order differently, divided by the number of all pairs. Pairs that are
// equal in a list count as neither. Requires lists of the same length; returns 0 for less than two
// numbers.
double calc_rank_agreement(std::span<const double> a, std::span<const double> b);

enum class CmaModelKind { linear, diagonal, full };

// The points of one run of the strategy, as shares of the box's width, and the model of them.
class CmaSurrogate {
 public:
  CmaSurrogate(std::size_t dimension, std::size_t population);
  ~CmaSurrogate();
  CmaSurrogate(CmaSurrogate&&) noexcept;
  CmaSurrogate& operator=(CmaSurrogate&&) noexcept;

  std::size_t size() const { return values_.size(); }
  bool is_fitted() const { return is_fitted_; }
  CmaModelKind kind() const { return kind_; }

  // Adds an evaluated point and forgets the oldest of too many. The model stays as it is.
  void add(std::vector<double> point, double value);
  // Fits the model to the points. `distribution` decides the coordinates. Requires a point. Costs
  // O(n^6) operations for n variables once the model is full: 10 ms for 20 variables. Values too
  // large for the arithmetic leave no fitted model.
  void fit(const CmaDistribution& distribution);

  // These three require a fitted model.
  double calc_value(std::span<const double> point) const;
  // Returns Kendall's correlation of the values and the model's for the last
  // max(15, min(1.2 evaluated, 0.75 lambda)) points, or 0 for less than three.
  double calc_agreement(std::size_t evaluated) const;
  // Returns the minimum of the model within `radius` standard deviations of the distribution's
  // mean. It may lie outside the box.
  std::vector<double> find_minimum(double radius) const;

 private:
  struct Model;

  std::size_t dimension_;
  std::size_t population_;
  std::vector<std::vector<double>> points_;  // the oldest first
  std::vector<double> values_;
  bool is_fitted_ = false;
  CmaModelKind kind_ = CmaModelKind::linear;
  std::unique_ptr<Model> model_;
};

}  // namespace armwright
