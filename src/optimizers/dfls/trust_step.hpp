// Steps of a trust region in a box: the exact minimiser of a linear least-squares model, and the
// extremes of a linear function, over
//   lower <= s <= upper,  |s| <= radius,   where lower <= 0 <= upper and |.| is the 2-norm.
//
// The minimiser of |r + J s|^2 is computed by its multiplier. For lambda > 0, let s(lambda) minimise
// |r + J s|^2 + lambda |s|^2 over the box alone. An active set finds it: a sequence of least-squares
// problems in the variables that are off their bounds, each solved by QR, so that the condition of
// J counts and not its square (Stark and Parker 1995, Bounded-variable least-squares: an algorithm
// and applications). |s(lambda)| falls as lambda grows. Newton's method on 1/radius - 1/|s(lambda)|
// within a bracket finds |s| = radius (More and Sorensen 1983, Computing a trust region step).
// Deviation from the sources: the bounds take part in both iterations, so the result satisfies the
// optimality conditions of the whole problem.
// Directions along which the model is flat get no step: lambda has a lower limit.
// Cost: O(n^3) per change of the active set. Meant for up to about 100 variables.
#pragma once

#include <Eigen/Core>

namespace armwright {

struct StepBox {
  Eigen::VectorXd lower;  // <= 0
  Eigen::VectorXd upper;  // >= 0
};

// Returns the step that minimises |residuals + jacobian s|^2. The jacobian has one row per residual
// and one column per variable.
Eigen::VectorXd solve_trust_region(const Eigen::MatrixXd& jacobian,
                                   const Eigen::VectorXd& residuals, const StepBox& box,
                                   double radius);

// Returns the step that makes |gradient' s| largest.
Eigen::VectorXd find_extreme_step(const Eigen::VectorXd& gradient, const StepBox& box,
                                  double radius);

}  // namespace armwright
