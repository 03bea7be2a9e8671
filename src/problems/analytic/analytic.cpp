#include "problems/analytic/analytic.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// Larger than every value that a function has inside its box; the largest is below 1e10, of the
// 1000-dimensional ellipsoid. Small enough that a model fitted through it keeps its digits: its
// square is far from overflow, and the spacing of numbers near it is 1e-4.
constexpr double kPenalty = 1e12;

double calc_shift(int index) {
  const double multiple = (index + 1) * (std::numbers::phi - 1);
  return 4 * (multiple - std::floor(multiple) - 0.5);
}

class AnalyticProblem : public Problem {
 public:
  AnalyticProblem(const AnalyticFunction& function, int dimension) : function_(function) {
    description_.name = function.name;
    description_.summary = fmt::format("{}; {} {}", function.summary, dimension,
                                       dimension == 1 ? "variable" : "variables");
    for (int i = 0; i < dimension; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const double start = function.start.size() == 1 ? function.start[0] : function.start[place];
      description_.variables.push_back({.name = fmt::format("x_{}", i + 1),
                                        .unit = "",
                                        .lower = function.lower,
                                        .upper = function.upper,
                                        .start = start});
      const bool shifted = function.minimiser.empty();
      shift_.push_back(shifted ? calc_shift(i) : 0);
      description_.known_optimum.push_back(shifted ? shift_.back() : function.minimiser[place]);
    }
    // A function without a minimiser of its own is least where z is 0.
    description_.optimum = function.calc_value(
        function.minimiser.empty() ? std::vector<double>(shift_.size()) : function.minimiser);
    description_.objectives = {{"f", ""}};
    for (int i = 0; i < function.constraint_count; ++i) {
      description_.constraints.push_back({fmt::format("g_{}", i + 1), ""});
    }
    description_.cost_unit = "function evaluation";
    description_.has_residuals = function.calc_residuals != nullptr;
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
      outcomes[job].error = function_.calc_value(z);
      if (function_.calc_constraints != nullptr) {
        outcomes[job].metrics = function_.calc_constraints(z);
      }
      if (jobs[job].residuals && function_.calc_residuals != nullptr) {
        outcomes[job].residuals = function_.calc_residuals(z);
      }
    }
    return outcomes;
  }

  // Takes the mean over the cases that have an error. The metrics of an outcome are its constraint
  // values.
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
  // Returns the residuals of all cases that have an error, divided by sqrt(count). The sum of their
  // squares is then the mean over these `count` cases.
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

  const AnalyticFunction& function_;  // a row of the table, which lives as long as the program
  ProblemDescription description_;
  std::vector<double> shift_;
};

}  // namespace

std::vector<std::string> analytic_names() {
  std::vector<std::string> names;
  for (const AnalyticFunction& function : analytic_table()) {
    names.push_back(function.name);
  }
  return names;
}

const AnalyticFunction& find_analytic(std::string_view name) {
  for (const AnalyticFunction& function : analytic_table()) {
    if (function.name == name) {
      return function;
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("analytic function", name, analytic_names()));
}

std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension) {
  const AnalyticFunction& function = find_analytic(name);
  if (dimension < function.smallest_dimension || dimension > function.largest_dimension) {
    throw Error(
        ErrorKind::usage,
        function.smallest_dimension == function.largest_dimension
            ? fmt::format("analytic function '{}': dimension is {}; it must be {}", function.name,
                          dimension, function.smallest_dimension)
            : fmt::format("analytic function '{}': dimension is {}; it must be between {} and {}",
                          function.name, dimension, function.smallest_dimension,
                          function.largest_dimension));
  }
  return std::make_unique<AnalyticProblem>(function, dimension);
}

std::unique_ptr<Problem> make_analytic(std::string_view name) {
  return make_analytic(name, find_analytic(name).default_dimension);
}

}  // namespace armwright
