// The two optimizers that use Ceres Solver, which only the module libarmwright_ceres.so contains
// (optimizers/ceres_module). The module is loaded when an optimizer is made.
//
// Both work in coordinates p: p = 0 at the start, and the box is 10 wide in every variable, on the
// variable's own scale. So a factor of ten is about 1, trust regions and damping mean the same for
// every variable and problem, and p = 0 is exactly the start.
#pragma once

#include <memory>
#include <vector>

#include "optimizers/interface/differences.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the rows ceres:lm and ceres:bfgs. Without Ceres or its module they say so and cannot be
// used.
std::vector<OptimizerRow> make_ceres_rows();

enum class ResidualTransform { automatic, logarithm, none };

// Settings of Levenberg-Marquardt on Score::residuals (Levenberg 1944; Marquardt 1963). With the
// logarithm, a residual r becomes
//   ln(1 + (r / f)^2),  f = floor times the root mean square of the residuals at the start,
// the logarithm of its share of the objective, and flat where that share is small. Every share then
// counts by its ratio to the value at the start. In both cases the residuals are divided by the
// square root of their number (and, without the logarithm, by the root mean square at the start),
// so that the damping means the same for every problem.
//
// Simulated objectives are rough: a slope over a short distance shows only the roughness. So the
// differences begin wide. Each time Ceres ends, it starts again from the best point with half the
// step and with newly scaled residuals. This is the idea of implicit filtering (Gilmore and Kelley
// 1995, An implicit filtering algorithm for optimization of functions with many local minima).
//
// With exact derivatives there is no step. Ceres starts again with newly scaled residuals as long
// as this improves the result. Very large slopes, as of chaotic motion, are cut to a size that a
// step can use.
struct LevenbergSettings {
  bool exact = false;  // use exact derivatives
  // automatic: the logarithm if every variable has a logarithmic scale
  ResidualTransform transform = ResidualTransform::automatic;
  double floor = 0.1;
  DifferenceSettings differences{.step = 0};  // the first, widest step; 0: the transform decides
  double smallest_step = 0.0005;              // the last, narrowest step, as a share of the box
  bool jacobi_scaling = false;
  double min_damping = 0.5;
  double initial_radius = 1;
  double function_tolerance = 1e-6;
  double parameter_tolerance = 1e-8;
};

// Settings of BFGS with Wolfe line searches on calc_merit(). The coordinates map into the box, so
// that no point lies outside:
//   u = c + w/2 (sin(a + 2 p/10) - sin(a)),  w the width of the box.
struct BfgsSettings {
  DifferenceSettings differences;
  double initial_step = 0.05;  // longest first step, share of the box
  double function_tolerance = 1e-6;
  double parameter_tolerance = 1e-8;
  double constraint_weight = 1000;
};

// Load the module and make the optimizers. Throw Error{bad_data} as load_module().
std::unique_ptr<Optimizer> make_levenberg_marquardt(const LevenbergSettings& settings);
std::unique_ptr<Optimizer> make_bfgs(const BfgsSettings& settings);

}  // namespace armwright
