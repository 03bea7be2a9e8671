// The border between the program and the module libarmwright_ceres.so, which alone contains Ceres
// Solver and needs its libraries. This header includes only the standard library.
//
// No exception crosses the border, because Ceres does not expect any: functions of the program that
// fail say so, and Ceres reports its own failures as results.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace armwright {

// What is minimised. The program implements it. None of the functions may throw.
class CeresFunction {
 public:
  virtual ~CeresFunction() = default;
  // Calculates the values and, unless `derivatives` is null, their derivatives: a row per value.
  // Returns false if the point cannot be evaluated.
  virtual bool evaluate(const double* p, double* values, double* derivatives) = 0;
  // Returns whether to end after an iteration.
  virtual bool stopped() const = 0;
};

// The residuals are the values of the function.
struct CeresLeastSquares {
  std::size_t residual_count = 0;
  std::vector<double> lower = {};  // bounds of p
  std::vector<double> upper = {};
  bool jacobi_scaling = false;
  double min_damping = 0;
  double initial_radius = 0;
  double function_tolerance = 0;
  double parameter_tolerance = 0;
};

// The function has one value.
struct CeresLineSearch {
  double function_tolerance = 0;
  double parameter_tolerance = 0;
};

// The methods of Ceres. The module implements it. All functions begin at p and leave the best point
// in it.
class CeresSolver {
 public:
  virtual ~CeresSolver() = default;
  // Levenberg-Marquardt within bounds.
  virtual void minimize_squares(CeresFunction& function, std::vector<double>& p,
                                const CeresLeastSquares& settings) const = 0;
  // BFGS with Wolfe line searches. Returns why it ended, in the words of Ceres.
  virtual std::string search_lines(CeresFunction& function, std::vector<double>& p,
                                   const CeresLineSearch& settings) const = 0;
};

// The module's entry; the object lives as long as the program.
using GetCeresSolver = const CeresSolver*();
inline constexpr const char* kCeresEntry = "armwright_get_ceres_solver";

}  // namespace armwright
