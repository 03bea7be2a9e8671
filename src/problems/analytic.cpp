#include "problems/analytic.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using Point = std::span<const double>;

// More than any of the functions reaches inside its box (largest: the 1000-dimensional ellipsoid,
// below 1e10), yet small enough that models fitted through it keep their digits: its square is far
// from overflow and its spacing is 1e-4.
constexpr double kPenalty = 1e12;

// Off the centre of the box, and outside (-2, 2), where the coordinates of the minimiser lie.
constexpr double kStart = -2.5;

double calc_shift(int index) {
  const double multiple = (index + 1) * (std::numbers::phi - 1);
  return 4 * (multiple - std::floor(multiple) - 0.5);
}

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

// What the functions are the squares of; the sum of those is the value up to rounding.
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

struct Definition {
  AnalyticRow row;
  double lower = 0;
  double upper = 0;
  std::vector<double> start = {};      // one number: the same for every variable
  std::vector<double> minimiser = {};  // empty: the shift
  int constraint_count = 0;
  double (*calc_value)(Point) = nullptr;
  std::vector<double> (*calc_constraints)(Point) = nullptr;
  std::vector<double> (*calc_residuals)(Point) = nullptr;
};

const std::vector<Definition>& definitions() {
  static const std::vector<Definition> table = {
      {.row = {.name = "sphere",
               .summary = "Sum of squares; the easiest function there is",
               .source = "De Jong 1975, An analysis of the behavior of a class of genetic adaptive "
                         "systems, F1"},
       .lower = -5,
       .upper = 5,
       .start = {kStart},
       .calc_value = calc_sphere,
       .calc_residuals = calc_sphere_residuals},
      {.row = {.name = "ellipsoid",
               .summary = "Separable quadratic of condition number 1e6",
               .source = "Hansen, Finck, Ros and Auger 2009, Real-parameter black-box optimization "
                         "benchmarking: noiseless functions definitions, f2 without oscillation"},
       .lower = -5,
       .upper = 5,
       .start = {kStart},
       .calc_value = calc_ellipsoid,
       .calc_residuals = calc_ellipsoid_residuals},
      {.row = {.name = "rosenbrock",
               .summary = "A long, bent, flat valley",
               .source = "Rosenbrock 1960, An automatic method for finding the greatest or least "
                         "value of a function; chained to n variables",
               .smallest_dimension = 2},
       .lower = -5,
       .upper = 5,
       .start = {kStart},
       .calc_value = calc_rosenbrock,
       .calc_residuals = calc_rosenbrock_residuals},
      {.row = {.name = "rastrigin",
               .summary = "A bowl with a regular grid of local minima",
               .source = "Rastrigin 1974, Systems of extremal control; Muehlenbein, Schomisch and "
                         "Born 1991 for n variables"},
       .lower = -5.12,
       .upper = 5.12,
       .start = {kStart},
       .calc_value = calc_rastrigin,
       .calc_residuals = calc_rastrigin_residuals},
      {.row = {.name = "constrained",
               .summary = "Rosen-Suzuki: a convex quadratic under three quadratic constraints",
               .source = "Rosen and Suzuki 1965, Construction of nonlinear programming test "
                         "problems; Hock and Schittkowski 1981, problem 43 (our box and start)",
               .smallest_dimension = 4,
               .largest_dimension = 4,
               .default_dimension = 4},
       .lower = -4,
       .upper = 5,
       .start = {-1, -1, -1,
                 0.5},  // feasible; the source's origin shares a coordinate with the minimiser
       .minimiser = {0, 1, 2, -1},
       .constraint_count = 3,
       .calc_value = calc_rosen_suzuki,
       .calc_constraints = calc_rosen_suzuki_constraints},
  };
  return table;
}

const Definition& find_definition(std::string_view name) {
  for (const Definition& definition : definitions()) {
    if (definition.row.name == name) {
      return definition;
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("analytic function", name, analytic_names()));
}

class AnalyticProblem : public Problem {
 public:
  AnalyticProblem(const Definition& definition, int dimension) : definition_(definition) {
    description_.name = definition.row.name;
    description_.summary = fmt::format("{}; {} {}", definition.row.summary, dimension,
                                       dimension == 1 ? "variable" : "variables");
    for (int i = 0; i < dimension; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const double start =
          definition.start.size() == 1 ? definition.start[0] : definition.start[place];
      description_.variables.push_back({.name = fmt::format("x_{}", i + 1),
                                        .unit = "",
                                        .lower = definition.lower,
                                        .upper = definition.upper,
                                        .start = start});
      const bool shifted = definition.minimiser.empty();
      shift_.push_back(shifted ? calc_shift(i) : 0);
      description_.known_optimum.push_back(shifted ? shift_.back() : definition.minimiser[place]);
    }
    description_.objectives = {{"f", ""}};
    for (int i = 0; i < definition.constraint_count; ++i) {
      description_.constraints.push_back({fmt::format("g_{}", i + 1), ""});
    }
    description_.cost_unit = "function evaluation";
    description_.has_residuals = definition.calc_residuals != nullptr;
  }

  const ProblemDescription& description() const override { return description_; }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    std::vector<double> z(shift_.size());
    for (std::size_t job = 0; job < jobs.size(); ++job) {
      assert(jobs[job].x.size() == z.size());
      for (std::size_t i = 0; i < z.size(); ++i) {
        z[i] = jobs[job].x[i] - shift_[i];
      }
      outcomes[job].error = definition_.calc_value(z);
      if (definition_.calc_constraints != nullptr) {
        outcomes[job].metrics = definition_.calc_constraints(z);
      }
      if (definition_.calc_residuals != nullptr) {
        outcomes[job].residuals = definition_.calc_residuals(z);
      }
    }
    return outcomes;
  }

  // The mean over the cases that yielded a number; an outcome's metrics are its constraint values.
  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    evaluation.case_errors.reserve(outcomes.size());
    double error_sum = 0;
    std::vector<double> constraint_sums(description_.constraints.size());
    for (const CaseOutcome& outcome : outcomes) {
      if (outcome.status != EvaluationStatus::ok && evaluation.status == EvaluationStatus::ok) {
        evaluation.status = outcome.status;
        evaluation.reason = outcome.reason;
      }
      if (!outcome.has_error) {
        evaluation.case_errors.push_back(std::numeric_limits<double>::quiet_NaN());
        ++evaluation.failed_cases;
        continue;
      }
      evaluation.case_errors.push_back(outcome.error);
      error_sum += outcome.error;
      assert(outcome.metrics.size() == constraint_sums.size());
      for (std::size_t i = 0; i < constraint_sums.size(); ++i) {
        constraint_sums[i] += outcome.metrics[i];
      }
    }
    const double count = static_cast<double>(outcomes.size()) - evaluation.failed_cases;
    if (count > 0) {
      evaluation.objectives = {error_sum / count};
      for (const double sum : constraint_sums) {
        evaluation.constraint_values.push_back(sum / count);
      }
      evaluation.residuals = collect_residuals(outcomes, count);
    }
    return evaluation;
  }

  std::vector<double> penalty_objectives() const override { return {kPenalty}; }

 private:
  // Those of every case that yielded a number, so scaled that their squares add up to the mean.
  static std::vector<double> collect_residuals(std::span<const CaseOutcome> outcomes,
                                               double count) {
    std::vector<double> residuals;
    residuals.reserve(outcomes.size() * outcomes.front().residuals.size());
    for (const CaseOutcome& outcome : outcomes) {
      if (outcome.has_error) {
        residuals.insert(residuals.end(), outcome.residuals.begin(), outcome.residuals.end());
      }
    }
    const double root = std::sqrt(count);
    for (double& residual : residuals) {
      residual /= root;
    }
    return residuals;
  }

  const Definition& definition_;  // lives as long as the program
  ProblemDescription description_;
  std::vector<double> shift_;
};

}  // namespace

const std::vector<AnalyticRow>& analytic_table() {
  static const std::vector<AnalyticRow> rows = [] {
    std::vector<AnalyticRow> collected;
    for (const Definition& definition : definitions()) {
      collected.push_back(definition.row);
    }
    return collected;
  }();
  return rows;
}

std::vector<std::string> analytic_names() {
  std::vector<std::string> names;
  for (const Definition& definition : definitions()) {
    names.push_back(definition.row.name);
  }
  return names;
}

const AnalyticRow& find_analytic(std::string_view name) {
  return find_definition(name).row;
}

std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension) {
  const Definition& definition = find_definition(name);
  const AnalyticRow& row = definition.row;
  if (dimension < row.smallest_dimension || dimension > row.largest_dimension) {
    throw Error(
        ErrorKind::usage,
        row.smallest_dimension == row.largest_dimension
            ? fmt::format("analytic function '{}': dimension is {}; it must be {}", row.name,
                          dimension, row.smallest_dimension)
            : fmt::format("analytic function '{}': dimension is {}; it must be between {} and {}",
                          row.name, dimension, row.smallest_dimension, row.largest_dimension));
  }
  return std::make_unique<AnalyticProblem>(definition, dimension);
}

std::unique_ptr<Problem> make_analytic(std::string_view name) {
  return make_analytic(name, find_analytic(name).default_dimension);
}

}  // namespace armwright
