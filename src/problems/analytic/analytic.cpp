#include "problems/analytic/analytic.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/analytic/analytic_functions.hpp"

namespace armwright {
namespace {

// More than any of the functions reaches inside its box (largest: the 1000-dimensional ellipsoid,
// below 1e10), yet small enough that models fitted through it keep their digits: its square is far
// from overflow and its spacing is 1e-4.
constexpr double kPenalty = 1e12;

double calc_shift(int index) {
  const double multiple = (index + 1) * (std::numbers::phi - 1);
  return 4 * (multiple - std::floor(multiple) - 0.5);
}

const AnalyticDefinition& find_definition(std::string_view name) {
  for (const AnalyticDefinition& definition : analytic_definitions()) {
    if (definition.row.name == name) {
      return definition;
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("analytic function", name, analytic_names()));
}

class AnalyticProblem : public Problem {
 public:
  AnalyticProblem(const AnalyticDefinition& definition, int dimension) : definition_(definition) {
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
      if (jobs[job].residuals && definition_.calc_residuals != nullptr) {
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

  const AnalyticDefinition& definition_;  // lives as long as the program
  ProblemDescription description_;
  std::vector<double> shift_;
};

}  // namespace

const std::vector<AnalyticRow>& analytic_table() {
  static const std::vector<AnalyticRow> rows = [] {
    std::vector<AnalyticRow> collected;
    for (const AnalyticDefinition& definition : analytic_definitions()) {
      collected.push_back(definition.row);
    }
    return collected;
  }();
  return rows;
}

std::vector<std::string> analytic_names() {
  std::vector<std::string> names;
  for (const AnalyticDefinition& definition : analytic_definitions()) {
    names.push_back(definition.row.name);
  }
  return names;
}

const AnalyticRow& find_analytic(std::string_view name) {
  return find_definition(name).row;
}

std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension) {
  const AnalyticDefinition& definition = find_definition(name);
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
