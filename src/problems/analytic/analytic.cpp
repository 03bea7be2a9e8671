#include "problems/analytic/analytic.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/analytic/bbob.hpp"
#include "problems/analytic/function_instance.hpp"
#include "problems/interface/add_outcome.hpp"

namespace armwright {
namespace {

// Larger than every value that a function has inside its box; the largest is below 2e10, of the
// 1000-dimensional ellipsoid-int. Small enough that a model fitted through it keeps its digits: its
// square is far from overflow, and the spacing of numbers near it is 1e-4.
constexpr double kPenalty = 1e12;

// A difference of function values that matters in comparisons. BBOB's targets end there too.
constexpr double kResolution = 1e-8;

class AnalyticProblem : public Problem {
 public:
  AnalyticProblem(const AnalyticFunction& function, const FunctionChoice& choice)
      : function_(function), instance_(make_instance(function, choice)) {
    const int dimension = choice.dimension;
    description_.name = function.name;
    description_.summary = fmt::format("{}; {} {}", function.summary, dimension,
                                       dimension == 1 ? "variable" : "variables");
    if (choice.instance > 0) {
      description_.summary += fmt::format(", instance {}", choice.instance);
    }
    const auto n = static_cast<std::size_t>(dimension);
    const std::size_t first_integer = n - count_integers(function, n);
    for (int i = 0; i < dimension; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const double start = function.start.size() == 1 ? function.start[0] : function.start[place];
      description_.variables.push_back(
          {.name = fmt::format("x_{}", i + 1),
           .unit = "",
           .lower = function.lower,
           .upper = function.upper,
           .start = start,
           .type = place < first_integer ? VariableType::real : VariableType::integer});
    }
    description_.known_optimum = instance_.minimiser;
    description_.optimum = function.minimum + instance_.f_opt;
    description_.resolution = kResolution;
    if (function.calc_objectives == nullptr) {
      description_.objectives = {{"f", ""}};
    } else {
      for (int i = 0; i < function.objective_count; ++i) {
        description_.objectives.push_back({fmt::format("f_{}", i + 1), ""});
      }
      description_.objective_weights.assign(description_.objectives.size(), 1.0);
    }
    for (int i = 0; i < function.constraint_count; ++i) {
      description_.constraints.push_back({fmt::format("g_{}", i + 1), ""});
    }
    description_.cost_unit = "function evaluation";
    description_.has_residuals = function.calc_residuals != nullptr && !choice.adds_f_opt;
    if (choice.adds_f_opt) {
      description_.residuals_advice = "set function.add_f_opt to false";
    }
  }

  const ProblemDescription& description() const override { return description_; }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    std::vector<double> z(description_.variables.size());
    for (std::size_t job = 0; job < jobs.size(); ++job) {
      assert(jobs[job].x.size() == z.size());
      instance_.calc_z(jobs[job].x, z);
      outcomes[job].error = function_.calc_value(z) + instance_.f_opt;
      if (function_.calc_objectives != nullptr) {
        outcomes[job].metrics = function_.calc_objectives(z);
      }
      if (function_.calc_constraints != nullptr) {
        const std::vector<double> constraints = function_.calc_constraints(z);
        outcomes[job].metrics.insert(outcomes[job].metrics.end(), constraints.begin(),
                                     constraints.end());
      }
      if (jobs[job].residuals && description_.has_residuals) {
        outcomes[job].residuals = function_.calc_residuals(z);
      }
    }
    return outcomes;
  }

  // Takes the mean over the cases that have an error. The metrics of an outcome are its objectives,
  // if there are several, and its constraint values.
  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    evaluation.case_errors.reserve(outcomes.size());
    double error_sum = 0;
    const std::size_t objectives =
        function_.calc_objectives == nullptr ? 0 : description_.objectives.size();
    std::vector<double> sums(objectives + description_.constraints.size());
    for (const CaseOutcome& outcome : outcomes) {
      if (!add_outcome(outcome, evaluation)) {
        continue;
      }
      error_sum += outcome.error;
      assert(outcome.metrics.size() == sums.size());
      for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i] += outcome.metrics[i];
      }
    }
    const double count = static_cast<double>(outcomes.size()) - evaluation.failed_cases;
    if (count > 0) {
      if (objectives == 0) {
        evaluation.objectives = {error_sum / count};
      }
      for (std::size_t i = 0; i < sums.size(); ++i) {
        (i < objectives ? evaluation.objectives : evaluation.constraint_values)
            .push_back(sums[i] / count);
      }
      evaluation.residuals = collect_residuals(outcomes, count);
    }
    return evaluation;
  }

  std::vector<double> penalty_objectives() const override {
    return std::vector<double>(description_.objectives.size(), kPenalty);
  }

 private:
  static FunctionInstance make_instance(const AnalyticFunction& function,
                                        const FunctionChoice& choice) {
    const auto dimension = static_cast<std::size_t>(choice.dimension);
    if (choice.instance == 0) {
      return make_plain_instance(function, dimension);
    }
    if (function.bbob == 0) {
      return make_random_instance(function, dimension, choice.instance);
    }
    FunctionInstance instance = make_bbob_instance(function.bbob, dimension, choice.instance);
    instance.f_opt = choice.adds_f_opt ? instance.f_opt : 0;
    return instance;
  }

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
  FunctionInstance instance_;
  ProblemDescription description_;
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
  throw Error(ErrorKind::usage, describe_unknown("analytic function", name, analytic_names(),
                                                 "armwright list settings function.name"));
}

std::size_t count_integers(const AnalyticFunction& function, std::size_t dimension) {
  return function.has_integers ? dimension / 2 : 0;
}

int get_first_instance(const AnalyticFunction& function) {
  return function.bbob != 0 ? 1 : 0;
}

std::unique_ptr<Problem> make_analytic(const FunctionChoice& choice) {
  const AnalyticFunction& function = find_analytic(choice.name);
  const auto refuse = [&](std::string_view what, int is, int lowest, int highest) {
    const std::string allowed = lowest == highest
                                    ? fmt::format("{}", lowest)
                                    : fmt::format("between {} and {}", lowest, highest);
    throw Error(ErrorKind::usage, fmt::format("analytic function '{}': {} is {}; it must be {}",
                                              function.name, what, is, allowed));
  };
  if (choice.dimension < function.smallest_dimension ||
      choice.dimension > function.largest_dimension) {
    refuse("dimension", choice.dimension, function.smallest_dimension, function.largest_dimension);
  }
  const int first = get_first_instance(function);
  const int last = function.has_instances ? kMostInstances : 0;
  if (choice.instance < first || choice.instance > last) {
    refuse("instance", choice.instance, first, last);
  }
  return std::make_unique<AnalyticProblem>(function, choice);
}

std::unique_ptr<Problem> make_analytic(std::string_view name, int dimension) {
  const AnalyticFunction& function = find_analytic(name);
  return make_analytic({.name = function.name,
                        .dimension = dimension,
                        .instance = get_first_instance(function),
                        .adds_f_opt = function.bbob != 0});
}

std::unique_ptr<Problem> make_analytic(std::string_view name) {
  return make_analytic(name, find_analytic(name).default_dimension);
}

}  // namespace armwright
