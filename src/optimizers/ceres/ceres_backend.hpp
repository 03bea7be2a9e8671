// The two optimizers that are made of Ceres Solver. Its headers are included by their .cpp files
// and ceres_support.hpp only.
//
// Both work in coordinates p of their own: p = 0 at the start and the box 10 wide in every
// variable, on the variable's own scale. So a factor of ten is about one, trust regions and damping
// mean the same for every variable and problem, and the start is met exactly.
#pragma once

#include <memory>

#include "optimizers/interface/differences.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

enum class ResidualTransform { automatic, logarithm, none };

// Levenberg-Marquardt on Score::residuals (Levenberg 1944; Marquardt 1963). With the logarithm a
// residual r is ln(1 + (r/f)^2), f = floor times the start's root mean square: the logarithm of its
// share of the objective, level where that is small. Every share then counts by its ratio to what
// it was. Either way the residuals are divided by the root of their number (and, without the
// logarithm, by the start's root mean square), so that the damping means the same for every
// problem.
//
// Simulations are rough: slopes over short distances are those of the roughness. So the differences
// begin wide; each time that Ceres comes to its end, it starts again from the best point with half
// the step, which also scales the residuals anew (the idea of implicit filtering; Gilmore and
// Kelley 1995, An implicit filtering algorithm for optimization of functions with many local
// minima).
//
// With exact derivatives there is no step; it starts again, with the residuals scaled anew, as long
// as that gains something. Slopes without bounds, those of chaos, are cut to what a step can use.
struct LevenbergSettings {
  bool exact = false;                                          // derivatives
  ResidualTransform transform = ResidualTransform::automatic;  // the logarithm where every variable
                                                               // is logarithmic
  double floor = 0.1;
  DifferenceSettings differences{.step = 0};  // the widest; 0: by the transform
  double smallest_step = 0.0005;              // the narrowest, share of the box
  bool jacobi_scaling = false;
  double min_damping = 0.5;
  double initial_radius = 1;
  double function_tolerance = 1e-6;
  double parameter_tolerance = 1e-8;
};

// BFGS with Wolfe line searches on calc_merit(). The box is folded into the coordinates:
// u = c + w/2 (sin(a + 2 p/10) - sin(a)), w the box's width, so that no point lies outside it.
struct BfgsSettings {
  DifferenceSettings differences;
  double initial_step = 0.05;  // longest first step, share of the box
  double function_tolerance = 1e-6;
  double parameter_tolerance = 1e-8;
  double constraint_weight = 1000;
};

// Only in a build with Ceres (ARMWRIGHT_WITH_CERES).
std::unique_ptr<Optimizer> make_levenberg_marquardt(const LevenbergSettings& settings);
std::unique_ptr<Optimizer> make_bfgs(const BfgsSettings& settings);

}  // namespace armwright
