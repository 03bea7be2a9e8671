// A model of every residual about the best of a few evaluated points, the centre:
//   linear      r(x + s) = r + g' s
//   power law   r(x + s) = r exp(g' s)
// A power law is linear in log |r|. If the coordinates are logarithms, it is a product of powers of
// the variables: an effort limit's residual is one exactly, and errors nearly are. It serves a residual
// that has the same sign at all points, if the user of the model allows it.
//
// With n + 1 points in n variables, the model agrees with all of them. With fewer points, or points
// that hardly span the space, J is the matrix that agrees with them and is nearest (in the Frobenius
// norm) to the J before: Broyden's update for one point beside the centre. So the model keeps exact
// derivatives, or those of earlier points, in the directions that no point tells anything about.
//
// The Lagrange polynomial of a point is the linear function that is 1 there and 0 at the other
// points. Its size says how much a new point would improve the geometry of the set in place of the
// old one (Powell 2003, On trust region methods for unconstrained minimization without
// derivatives).
// Source: Cartis, Fiala, Marteau and Roberts 2019, Improving the flexibility and robustness of
// model-based derivative-free optimization solvers, sections 2 and 3; Zhang, Conn and Scheinberg
// 2010, A derivative-free algorithm for least-squares minimization. Deviations: they have no
// smallest change of the slopes and no power laws.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "optimizers/dfls/trust_step.hpp"

namespace armwright {

// An evaluated point.
struct ResidualSample {
  Eigen::VectorXd place;
  Eigen::VectorXd residuals;
  double square_sum = 0;  // of the residuals
};

class ResidualModel {
 public:
  // Makes a model of at least one point at different places. The best one is the centre. `jacobian`
  // holds the derivatives of the residuals at the centre that are known; 0 for others. One row per
  // residual, one column per variable.
  ResidualModel(std::vector<ResidualSample> samples, Eigen::MatrixXd jacobian, bool power_laws);
  // Makes a model of one point with more cases than the points of `old`. The residuals of its new
  // cases get the mean slopes of the old cases. `cases` and `old_cases` are numbers of cases
  // (Evaluator::cases()). Returns nothing if the residuals are not in the order of the cases.
  static std::optional<ResidualModel> extend(const ResidualModel& old, ResidualSample sample,
                                             std::size_t old_cases, std::size_t cases);

  const ResidualSample& centre() const { return samples_[centre_]; }
  // Returns the points, the one with the smallest sum of squares first.
  std::vector<ResidualSample> list_samples() const;
  // Returns the residuals at a step from the centre.
  Eigen::VectorXd predict(const Eigen::VectorXd& step) const;
  // Returns their derivatives at the centre.
  Eigen::MatrixXd calc_jacobian() const;
  // Returns the step that minimises the sum of the squared residuals within the box and the radius.
  Eigen::VectorXd find_step(const StepBox& box, double radius) const;
  // Returns true if the model has n + 1 points.
  bool is_full() const { return std::ssize(samples_) > slopes_.cols(); }

  // Adds a point. If there are n + 1 points already, or if it adds no direction, the point takes the
  // place of another one, chosen for the geometry within `radius` and for being far away. The best
  // point stays. A point that is better becomes the centre. Fits the model again.
  void include(ResidualSample sample, double radius);
  // Puts a point in the place of another one that is not the centre, and fits the model again.
  void replace(std::size_t index, ResidualSample sample);
  // Removes a point that is not the centre. The slopes stay as they are.
  void remove(std::size_t index);

  struct Distance {
    std::size_t index = 0;
    double length = 0;
  };
  // Returns the point that is furthest from the centre.
  Distance find_furthest() const;
  // Returns the gradient of the Lagrange polynomial of a point that is not the centre.
  Eigen::VectorXd calc_lagrange_gradient(std::size_t index) const;
  // Returns a direction of length 1 at right angles to those of all points. Only if !is_full().
  Eigen::VectorXd find_missing_direction() const;

 private:
  void fit();
  void choose_forms();
  bool is_power(Eigen::Index residual) const {
    return is_power_[static_cast<std::size_t>(residual)];
  }
  bool adds_direction(const Eigen::VectorXd& direction) const;
  std::size_t choose_leaver(const ResidualSample& sample, double radius) const;
  // The row of the directions that belongs to a point.
  Eigen::Index to_row(std::size_t index) const {
    return static_cast<Eigen::Index>(index < centre_ ? index : index - 1);
  }

  std::vector<ResidualSample> samples_;
  std::size_t centre_ = 0;
  bool power_laws_;
  std::vector<bool> is_power_;  // per residual
  Eigen::MatrixXd slopes_;      // g: one row per residual, one column per variable
  Eigen::MatrixXd lagrange_;    // gradients of the Lagrange polynomials: one column per other point
  Eigen::MatrixXd directions_;  // from the centre to the other points, of length 1: one row each
};

}  // namespace armwright
