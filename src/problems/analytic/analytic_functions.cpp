// The formulas of the analytic functions over z, and the table of all functions.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "problems/analytic/analytic.hpp"

namespace armwright {
namespace {

using Point = AnalyticFunction::Point;

// The start of every variable. It lies off the centre of the box and outside (-2, 2), the range of
// the minimiser's coordinates.
constexpr double kStart = -2.5;

double calc_sphere(Point z) {
  double sum = 0;
  for (const double zi : z) {
    sum += zi * zi;
  }
  return sum;
}

double calc_ellipsoid_weight(std::size_t index, std::size_t dimension) {
  constexpr double kCondition = 1e6;
  const double last = dimension > 1 ? static_cast<double>(dimension - 1) : 1;
  return std::pow(kCondition, static_cast<double>(index) / last);
}

double calc_ellipsoid(Point z) {
  double sum = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    sum += calc_ellipsoid_weight(i, z.size()) * z[i] * z[i];
  }
  return sum;
}

double calc_rosenbrock(Point z) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    const double y = z[i] + 1;
    const double valley = z[i + 1] + 1 - y * y;
    sum += 100 * valley * valley + z[i] * z[i];
  }
  return sum;
}

double calc_rastrigin(Point z) {
  double sum = 0;
  for (const double zi : z) {
    sum += zi * zi + 10 * (1 - std::cos(2 * std::numbers::pi * zi));
  }
  return sum;
}

// The sum of the squared residuals is the function's value up to rounding.
std::vector<double> calc_sphere_residuals(Point z) {
  return {z.begin(), z.end()};
}

std::vector<double> calc_ellipsoid_residuals(Point z) {
  std::vector<double> residuals;
  for (std::size_t i = 0; i < z.size(); ++i) {
    residuals.push_back(std::sqrt(calc_ellipsoid_weight(i, z.size())) * z[i]);
  }
  return residuals;
}

std::vector<double> calc_rosenbrock_residuals(Point z) {
  std::vector<double> residuals;
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    const double y = z[i] + 1;
    residuals.push_back(10 * (z[i + 1] + 1 - y * y));
    residuals.push_back(-z[i]);  // 1 - y
  }
  return residuals;
}

// 10 (1 - cos(2 pi z)) is 20 sin(pi z)^2.
std::vector<double> calc_rastrigin_residuals(Point z) {
  std::vector<double> residuals;
  for (const double zi : z) {
    residuals.push_back(zi);
    residuals.push_back(std::sqrt(20.0) * std::sin(std::numbers::pi * zi));
  }
  return residuals;
}

double calc_ackley(Point z) {
  const auto n = static_cast<double>(z.size());
  double cosines = 0;
  for (const double zi : z) {
    cosines += std::cos(2 * std::numbers::pi * zi);
  }
  // At z = 0 both terms are exactly 0.
  return 20 * (1 - std::exp(-0.2 * std::sqrt(calc_sphere(z) / n))) +
         (std::exp(1.0) - std::exp(cosines / n));
}

// The second variable of the source lies in [0, 15]. Here it is smaller by 5, so that both have the
// same bounds.
double calc_branin(Point x) {
  constexpr double kPi = std::numbers::pi;
  const double bend = x[1] + 5 - 5.1 / (4 * kPi * kPi) * x[0] * x[0] + 5 / kPi * x[0] - 6;
  return bend * bend + 10 * (1 - 1 / (8 * kPi)) * std::cos(x[0]) + 10;
}

double calc_hartmann6(Point x) {
  constexpr std::array<double, 4> kHeights = {1, 1.2, 3, 3.2};
  constexpr std::array<std::array<double, 6>, 4> kSharpness = {{{10, 3, 17, 3.5, 1.7, 8},
                                                                {0.05, 10, 17, 0.1, 8, 14},
                                                                {3, 3.5, 1.7, 10, 17, 8},
                                                                {17, 8, 0.05, 10, 0.1, 14}}};
  constexpr std::array<std::array<double, 6>, 4> kCentres = {
      {{0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886},
       {0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991},
       {0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650},
       {0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381}}};
  double sum = 0;
  for (std::size_t k = 0; k < kHeights.size(); ++k) {
    double distance = 0;
    for (std::size_t i = 0; i < kCentres[k].size(); ++i) {
      const double difference = x[i] - kCentres[k][i];
      distance += kSharpness[k][i] * difference * difference;
    }
    sum -= kHeights[k] * std::exp(-distance);
  }
  return sum;
}

double calc_rosen_suzuki(Point x) {
  return x[0] * x[0] + x[1] * x[1] + 2 * x[2] * x[2] + x[3] * x[3] - 5 * x[0] - 5 * x[1] -
         21 * x[2] + 7 * x[3];
}

std::vector<double> calc_rosen_suzuki_constraints(Point x) {
  const double a = x[0] * x[0];
  const double b = x[1] * x[1];
  const double c = x[2] * x[2];
  const double d = x[3] * x[3];
  return {a + b + c + d + x[0] - x[1] + x[2] - x[3] - 8, a + 2 * b + c + 2 * d - x[0] - x[3] - 10,
          2 * a + b + c + 2 * x[0] - x[1] - x[3] - 5};
}

std::vector<double> calc_zdt1_objectives(Point x) {
  double sum = 0;
  for (const double xi : x.subspan(1)) {
    sum += xi;
  }
  const double g = 1 + 9 * sum / static_cast<double>(x.size() - 1);
  return {x[0], g * (1 - std::sqrt(x[0] / g))};
}

std::vector<double> calc_dtlz2_objectives(Point x) {
  constexpr std::size_t kAngles = 2;
  double radius = 1;
  for (const double xi : x.subspan(kAngles)) {
    radius += (xi - 0.5) * (xi - 0.5);
  }
  const double a = 0.5 * std::numbers::pi * x[0];
  const double b = 0.5 * std::numbers::pi * x[1];
  return {radius * std::cos(a) * std::cos(b), radius * std::cos(a) * std::sin(b),
          radius * std::sin(a)};
}

template <std::vector<double> (*calc_objectives)(Point)>
double calc_objective_sum(Point x) {
  double sum = 0;
  for (const double objective : calc_objectives(x)) {
    sum += objective;
  }
  return sum;
}

// Returns the row of a function whose second half of variables are integers. Box and start are ours:
// the paper has the integers in [-10, 10], no bounds for the real variables, and a random start.
AnalyticFunction make_mixed_row(const std::string& name, const std::string& summary,
                                const std::string& paper_name, double (*calc_value)(Point),
                                std::vector<double> (*calc_residuals)(Point)) {
  return {.name = name,
          .summary = summary,
          .source =
              "Hamano, Saito, Nomura and Shirakawa 2022, CMA-ES with margin: lower-bounding "
              "marginal probability for mixed-integer black-box optimization, " +
              paper_name,
          .smallest_dimension = 2,
          .lower = -10,
          .upper = 10,
          .start = {-5},
          .has_instances = true,
          .has_integers = true,
          .calc_value = calc_value,
          .calc_residuals = calc_residuals};
}

// Returns the row of a function of BBOB: one of the sums above over the z of bbob.hpp.
AnalyticFunction make_bbob_row(int number, const std::string& summary, double (*calc_value)(Point),
                               std::vector<double> (*calc_residuals)(Point)) {
  return {.name = fmt::format("bbob-f{}", number),
          .summary = summary,
          .source = fmt::format("Hansen, Finck, Ros and Auger 2009, Real-parameter black-box "
                                "optimization benchmarking: noiseless functions definitions, f{}",
                                number),
          .smallest_dimension = 2,
          .largest_dimension = 40,
          .lower = -5,
          .upper = 5,
          .start = {kStart},
          .bbob = number,
          .has_instances = true,
          .calc_value = calc_value,
          .calc_residuals = calc_residuals};
}

}  // namespace

const std::vector<AnalyticFunction>& analytic_table() {
  static const std::vector<AnalyticFunction> table = {
      {.name = "sphere",
       .summary = "Sum of squares; the easiest function there is",
       .source = "De Jong 1975, An analysis of the behavior of a class of genetic adaptive "
                 "systems, F1",
       .lower = -5,
       .upper = 5,
       .start = {kStart},
       .has_instances = true,
       .calc_value = calc_sphere,
       .calc_residuals = calc_sphere_residuals},
      {.name = "ellipsoid",
       .summary = "Separable quadratic of condition number 1e6",
       .source = "Hansen, Finck, Ros and Auger 2009, Real-parameter black-box optimization "
                 "benchmarking: noiseless functions definitions, f2 without oscillation",
       .lower = -5,
       .upper = 5,
       .start = {kStart},
       .has_instances = true,
       .is_rotated = true,
       .calc_value = calc_ellipsoid,
       .calc_residuals = calc_ellipsoid_residuals},
      {.name = "rosenbrock",
       .summary = "A long, bent, flat valley",
       .source = "Rosenbrock 1960, An automatic method for finding the greatest or least "
                 "value of a function; chained to n variables",
       .smallest_dimension = 2,
       .lower = -5,
       .upper = 5,
       .start = {kStart},
       .has_instances = true,
       .is_rotated = true,
       .calc_value = calc_rosenbrock,
       .calc_residuals = calc_rosenbrock_residuals},
      {.name = "rastrigin",
       .summary = "A bowl with a regular grid of local minima",
       .source = "Rastrigin 1974, Systems of extremal control; Muehlenbein, Schomisch and "
                 "Born 1991 for n variables",
       .lower = -5.12,
       .upper = 5.12,
       .start = {kStart},
       .has_instances = true,
       .is_rotated = true,
       .calc_value = calc_rastrigin,
       .calc_residuals = calc_rastrigin_residuals},
      {.name = "ackley",
       .summary = "A nearly flat plain with many small dents around one deep hole",
       .source = "Ackley 1987, A connectionist machine for genetic hillclimbing; Baeck 1996 for n "
                 "variables",
       .lower = -32.768,
       .upper = 32.768,
       .start = {-20},
       .has_instances = true,
       .is_rotated = true,
       .calc_value = calc_ackley},
      {.name = "branin",
       .summary = "Two variables, three equal minima",
       .source = "Branin 1972, Widely convergent method for finding multiple solutions of "
                 "simultaneous nonlinear equations; Dixon and Szego 1978, The global optimization "
                 "problem: an introduction (its second variable is x_2 + 5)",
       .smallest_dimension = 2,
       .largest_dimension = 2,
       .default_dimension = 2,
       .lower = -5,
       .upper = 10,
       .start = {6},
       .minimiser = {std::numbers::pi, 2.275 - 5},  // where the square is 0 and the cosine is -1
       .minimum = 0.39788735772973816,  // 10 / (8 pi), with the rounding of calc_branin()
       .calc_value = calc_branin},
      {.name = "hartmann6",
       .summary = "Six variables, a sum of four bells with six local minima",
       .source = "Hartman 1973, Some experiments in global optimization; Dixon and Szego 1978, The "
                 "global optimization problem: an introduction",
       .smallest_dimension = 6,
       .largest_dimension = 6,
       .default_dimension = 6,
       .lower = 0,
       .upper = 1,
       .start = {0.5},
       // By Newton's method from the published minimiser, until the gradient was below 1e-14.
       .minimiser = {0.20168951100670543, 0.15001069182345797, 0.476873974221897,
                     0.2753324304940561, 0.31165161660011326, 0.6573005340656204},
       .minimum = -3.322368011415515,
       .calc_value = calc_hartmann6},
      {.name = "constrained",
       .summary = "Rosen-Suzuki: a convex quadratic under three quadratic constraints",
       .source = "Rosen and Suzuki 1965, Construction of nonlinear programming test "
                 "problems; Hock and Schittkowski 1981, problem 43 (our box and start)",
       .smallest_dimension = 4,
       .largest_dimension = 4,
       .default_dimension = 4,
       .lower = -4,
       .upper = 5,
       // Feasible. The source starts at the origin, which shares a coordinate with the minimiser.
       .start = {-1, -1, -1, 0.5},
       .minimiser = {0, 1, 2, -1},
       .minimum = -44,
       .constraint_count = 3,
       .calc_value = calc_rosen_suzuki,
       .calc_constraints = calc_rosen_suzuki_constraints},
      make_mixed_row("sphere-int", "Sum of squares; the second half of the variables are integers",
                     "SphereInt", calc_sphere, calc_sphere_residuals),
      make_mixed_row("ellipsoid-int",
                     "Separable quadratic of condition number 1e6; the second half of the "
                     "variables are integers",
                     "EllipsoidInt", calc_ellipsoid, calc_ellipsoid_residuals),
      {.name = "zdt1",
       .summary = "Two objectives with a convex front",
       .source = "Zitzler, Deb and Thiele 2000, Comparison of multiobjective evolutionary "
                 "algorithms: empirical results, T1",
       .smallest_dimension = 2,
       .largest_dimension = 30,
       .default_dimension = 30,
       .lower = 0,
       .upper = 1,
       .start = {0.5},
       .minimiser = {0.25, 0},  // of f_1 + 1 - sqrt(f_1)
       .minimum = 0.75,
       .objective_count = 2,
       .calc_value = calc_objective_sum<calc_zdt1_objectives>,
       .calc_objectives = calc_zdt1_objectives},
      {.name = "dtlz2",
       .summary = "Three objectives, whose front is a part of the unit sphere",
       .source = "Deb, Thiele, Laumanns and Zitzler 2005, Scalable test problems for evolutionary "
                 "multiobjective optimization, DTLZ2 with three objectives",
       .smallest_dimension = 3,
       .largest_dimension = 100,
       .default_dimension = 12,
       .lower = 0,
       .upper = 1,
       .start = {0.2},            // away from 1/2, where the front is
       .minimiser = {0, 0, 0.5},  // one of the front's corners, where the sum is smallest
       .minimum = 1,
       .objective_count = 3,
       .calc_value = calc_objective_sum<calc_dtlz2_objectives>,
       .calc_objectives = calc_dtlz2_objectives},
      make_bbob_row(1, "Sphere", calc_sphere, calc_sphere_residuals),
      make_bbob_row(2, "Separable ellipsoid with oscillation, condition number 1e6", calc_ellipsoid,
                    calc_ellipsoid_residuals),
      make_bbob_row(3, "Separable Rastrigin with oscillation and asymmetry", calc_rastrigin,
                    calc_rastrigin_residuals),
      make_bbob_row(8, "Rosenbrock", calc_rosenbrock, calc_rosenbrock_residuals),
      make_bbob_row(10, "Rotated ellipsoid with oscillation, condition number 1e6", calc_ellipsoid,
                    calc_ellipsoid_residuals),
      make_bbob_row(15, "Rotated Rastrigin with oscillation and asymmetry", calc_rastrigin,
                    calc_rastrigin_residuals),
  };
  return table;
}

}  // namespace armwright
