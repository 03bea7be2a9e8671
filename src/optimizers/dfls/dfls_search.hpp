// Derivative-free least squares in a trust region. Each iteration minimises the squares of models
// of the residuals (residual_model.hpp) within a radius and the bounds (trust_step.hpp), and
// evaluates that step. The ratio of the reduction to its prediction changes the radius.
//
// Two radii. The trust region's radius changes with every step. The resolution is its lower limit
// and only falls: after a failed step of a model that has nothing to improve. The search has
// converged when the resolution falls below smallest_radius. Steps below half of the resolution are
// not evaluated; they improve the model, or lower the resolution (safety steps).
//
// Improving the model moves the point that is furthest away, if it is further than twice the radius,
// to where its Lagrange polynomial is largest. If evaluations failed, directions are missing; then
// a point is evaluated along one of them. With exact derivatives, it computes them at the centre.
// Between two such computations every step updates them.
//
// After convergence, the search starts again about the best point with half the radius and the
// points on the other side, until that gains nothing. Simulated objectives are rough, and another
// model looks across the roughness that stopped the last one.
//
// If every variable is logarithmic, models are power laws and simulations are taken to be rough:
// descents end at a larger radius, restarts shrink it less, and only the last descent goes on to
// smallest_radius.
//
// When a model has nothing to improve, the run may add training cases (Evaluator::grow_cases()). The
// search goes on from its best point with the slopes that it knows.
//
// A failed evaluation is never part of a model: it makes the radius a quarter of the step.
//
// Source: Cartis, Fiala, Marteau and Roberts 2019, Improving the flexibility and robustness of
// model-based derivative-free optimization solvers, algorithm 1; the two radii are those of Powell
// 2009, The BOBYQA algorithm for bound constrained optimization without derivatives.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the row dfls.
std::vector<OptimizerRow> make_dfls_rows();

struct DflsSettings {
  double radius = 0.1;            // of the first trust region, share of the box
  double smallest_radius = 1e-7;  // share of the box
  int restarts = 10;              // at most
  bool exact = false;             // use the problem's derivatives
  bool power_laws = true;         // use them if every variable is logarithmic
};

// Searches until the evaluator stops or the search has converged; says why it ends. The problem has
// residuals. Throws every exception of the evaluator.
void search_with_dfls(const DflsSettings& settings, Evaluator& evaluator);

}  // namespace armwright
