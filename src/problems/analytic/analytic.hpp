// Analytic test functions: optimization problems with a known minimiser that cost almost nothing to
// evaluate. They show whether an optimizer works before it is used on a robot.
//
// With z = x - s, i = 1..n, all on a box of equal sides, minimum 0 at x = s:
//   sphere      sum z_i^2
//   ellipsoid   sum 10^(6 (i-1)/(n-1)) z_i^2, condition number 10^6 (n = 1: the sphere)
//   rosenbrock  sum_{i<n} 100 (y_{i+1} - y_i^2)^2 + (1 - y_i)^2 with y = z + 1
//   rastrigin   sum z_i^2 + 10 (1 - cos(2 pi z_i)), a local minimum near every integer point
// and with four variables
//   constrained the Rosen-Suzuki problem: convex, three inequality constraints (two active),
//               minimum -44 at (0, 1, 2, -1)
//
// The shift s_i = 4 (frac(i g) - 1/2), g = (sqrt(5) - 1)/2, lies in (-2, 2) and is the same for
// every function. It moves the minimiser away from the centre of the box, from the start and from
// any pattern that an optimizer might favour by construction.
//
// All functions but the last are sums of squares and have residuals. Rosenbrock has two residuals
// per pair of neighbouring variables: 10 (y_{i+1} - y_i^2) and 1 - y_i. Rastrigin has two residuals
// per variable: z_i and sqrt(20) sin(pi z_i).
//
// A test case is one function evaluation. The functions are deterministic, so every case gives the
// same value. Each AnalyticFunction names its source.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// A row of the table of analytic functions. The functions take z; all sizes are the dimension n.
struct AnalyticFunction {
  using Point = std::span<const double>;

  std::string name;
  std::string summary;
  std::string source;
  int smallest_dimension = 1;
  int largest_dimension = 1000;
  int default_dimension = 10;
  double lower = 0;  // bounds of every variable
  double upper = 0;
  std::vector<double> start = {};      // one number: the same for every variable
  std::vector<double> minimiser = {};  // empty: the shift s; otherwise s = 0
  double optimum = 0;                  // the smallest value that meets the constraints
  int constraint_count = 0;
  double (*calc_value)(Point) = nullptr;
  std::vector<double> (*calc_constraints)(Point) = nullptr;  // null: no constraints
  std::vector<double> (*calc_residuals)(Point) = nullptr;    // null: no residuals
};

// Returns all functions. The table lives as long as the program.
const std::vector<AnalyticFunction>& analytic_table();
std::vector<std::string> analytic_names();
// Throws Error{usage} for an unknown name.
const AnalyticFunction& find_analytic(std::string_view name);

// Makes the problem of a function. Throws Error{usage} for an unknown name and for a dimension that
// the function does not have. Without a dimension, uses the default one.
std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension);
std::unique_ptr<Problem> make_analytic(std::string_view name);

}  // namespace armwright
