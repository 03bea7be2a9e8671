// Analytic test functions: optimization problems whose minimiser is known and whose evaluation
// costs nothing. They show whether an optimizer works before a robot is spent on it.
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
// All but the last are sums of squares and carry their residuals, two a pair or variable where they
// have two terms: rosenbrock's 10 (y_{i+1} - y_i^2) and 1 - y_i, rastrigin's z_i and
// sqrt(20) sin(pi z_i).
//
// A test case is one function evaluation; the functions are deterministic, so every case gives the
// same value. Sources: see AnalyticRow::source of each.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

struct AnalyticRow {
  std::string name;
  std::string summary;
  std::string source;
  int smallest_dimension = 1;
  int largest_dimension = 1000;
  int default_dimension = 10;
};

const std::vector<AnalyticRow>& analytic_table();
std::vector<std::string> analytic_names();
const AnalyticRow& find_analytic(std::string_view name);  // Error{usage} if there is none

// Error{usage} for an unknown name or a dimension that the function does not have.
std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension);
std::unique_ptr<Problem> make_analytic(std::string_view name);  // of the default dimension

}  // namespace armwright
