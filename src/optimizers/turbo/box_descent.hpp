// Minimises a smooth function in a box: limited-memory BFGS (Nocedal and Wright 2006, Numerical
// Optimization, algorithm 7.4) on the coordinates that no bound holds, with a projected
// backtracking line search (Bertsekas 1982, Projected Newton methods for optimization problems with
// simple constraints). For functions that cost little: likelihoods and sample paths.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace armwright {

// Returns the value at x and writes the gradient. A value that is not finite marks a place where the
// function does not exist; the line search then takes a smaller step.
using SmoothFunction = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& gradient)>;

struct Box {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

// Moves x, a place in the box, to a smaller value and returns that value. Ends after `iterations`
// steps, or where a step gains less than 1e-9 of the value or 1e-12. The function is evaluated a few
// times per step.
double descend_in_box(const SmoothFunction& function, const Box& box, int iterations,
                      Eigen::VectorXd& x);

}  // namespace armwright
