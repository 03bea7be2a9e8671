// Analytic test functions: optimization problems with a known minimiser that cost almost nothing to
// evaluate. They show whether an optimizer works before it is used on a robot.
//
// These functions are sums over z, i = 1..n, with the minimum 0 at z = 0:
//   sphere      sum z_i^2
//   ellipsoid   sum 10^(6 (i-1)/(n-1)) z_i^2, condition number 10^6 (n = 1: the sphere)
//   rosenbrock  sum_{i<n} 100 (y_{i+1} - y_i^2)^2 + (1 - y_i)^2 with y = z + 1
//   rastrigin   sum z_i^2 + 10 (1 - cos(2 pi z_i)), a local minimum near every integer point
//   ackley      20 (1 - exp(-0.2 sqrt(sum z_i^2 / n))) + e - exp(sum cos(2 pi z_i) / n)
// and in a fixed dimension, without a shift
//   branin      two variables, three minima with the value 10 / (8 pi)
//   hartmann6   six variables, minimum -3.322368011415515
//   constrained the Rosen-Suzuki problem with four variables: convex, three inequality constraints
//               (two active), minimum -44 at (0, 1, 2, -1)
// and with several objectives, all in [0, 1]^n without a shift
//   zdt1        f_1 = x_1, f_2 = g (1 - sqrt(f_1 / g)), g = 1 + 9 sum_{i>1} x_i / (n - 1). The front
//               is f_2 = 1 - sqrt(f_1), where all variables but the first are 0. Its hypervolume up
//               to (1.1, 1.1) is 0.1 + 2/3 + 0.11.
//   dtlz2       f_1 = (1 + g) cos(a_1) cos(a_2), f_2 = (1 + g) cos(a_1) sin(a_2), f_3 = (1 + g)
//               sin(a_1), a_i = x_i pi / 2, g = sum_{i>2} (x_i - 1/2)^2. The front is the part of
//               the unit sphere with no negative coordinate, where g = 0.
// As one number, the objectives count as their sum.
// The functions sphere-int and ellipsoid-int are sphere and ellipsoid with whole numbers as the
// second half of the variables (floor(n/2) of them). Source: Hamano, Saito, Nomura and Shirakawa
// 2022, CMA-ES with Margin, SphereInt and EllipsoidInt.
// The functions bbob-f1, f2, f3, f8, f10 and f15 are the same sums over the z of bbob.hpp.
//
// An instance maps the decision vector x to z (function_instance.hpp). In the plain form, instance
// 0, z = x - s. The shift s_i = 4 (frac(i g) - 1/2), g = (sqrt(5) - 1)/2, lies in (-2, 2) and is
// the same for every function. It moves the minimiser away from the centre of the box, from the
// start and from any pattern that an optimizer might favour by construction. The other instances
// have a random shift and, except for the sphere, a random rotation. Along an integer variable the
// shift is a whole number: that of the plain form is rounded away from 0, the random one to the
// nearest. Functions with integer variables are not rotated.
//
// Sphere, ellipsoid, rosenbrock and rastrigin are sums of squares and have residuals. Rosenbrock has
// two residuals per pair of neighbouring variables: 10 (y_{i+1} - y_i^2) and 1 - y_i. Rastrigin has two
// residuals per variable: z_i and sqrt(20) sin(pi z_i). A BBOB function whose value includes f_opt
// is no sum of squares and has no residuals.
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
  std::vector<double> start = {};  // one number: the same for every variable
  // The minimiser of the plain form, whose shift s is then 0. If it is empty, the minimiser is s. If
  // there are more variables than numbers, the last number counts for the others too.
  std::vector<double> minimiser = {};
  double minimum = 0;          // the value at the minimiser, without f_opt
  int bbob = 0;                // its number if it is a function of BBOB; otherwise 0
  bool has_instances = false;  // false: it has the plain form only
  bool is_rotated = false;     // true: instances of our own functions are rotated
  bool has_integers = false;   // true: the second half of the variables are integers
  int constraint_count = 0;
  int objective_count = 1;
  double (*calc_value)(Point) = nullptr;                     // with several objectives, their sum
  std::vector<double> (*calc_objectives)(Point) = nullptr;   // null: the value is the objective
  std::vector<double> (*calc_constraints)(Point) = nullptr;  // null: no constraints
  std::vector<double> (*calc_residuals)(Point) = nullptr;    // null: no residuals
};

// What makes a problem of a function.
struct FunctionChoice {
  std::string name;
  int dimension = 0;
  // 0: the plain form. Functions of BBOB begin with 1, `constrained` has 0 only.
  int instance = 0;
  // True: replicate r of a comparison gets the instance with the number instance + r - 1
  // (make_replicate). The plain form is always the same for all replicates.
  bool instance_per_replicate = false;
  bool adds_f_opt = false;  // of a BBOB function: the value includes the instance's f_opt
};

// The instances are 1 to this number. BBOB's generator takes seeds below 2^31 - 1, and instance i
// uses seeds up to 10000 i + 1000015.
inline constexpr int kMostInstances = 200000;

// Returns all functions. The table lives as long as the program.
const std::vector<AnalyticFunction>& analytic_table();
std::vector<std::string> analytic_names();
// Throws Error{usage} for an unknown name.
const AnalyticFunction& find_analytic(std::string_view name);

// Returns how many of the n variables are integers. They are the last ones.
std::size_t count_integers(const AnalyticFunction& function, std::size_t dimension);

// Returns the lowest instance number: 0, the plain form, or 1 for a function of BBOB.
int get_first_instance(const AnalyticFunction& function);

// Makes the problem of a function. Throws Error{usage} for an unknown name, and for a dimension or
// an instance that the function does not have.
std::unique_ptr<Problem> make_analytic(const FunctionChoice& choice);
// The same for the plain form or, for a function of BBOB, for instance 1 with its f_opt. Without a
// dimension, uses the default one.
std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension);
std::unique_ptr<Problem> make_analytic(std::string_view name);

}  // namespace armwright
