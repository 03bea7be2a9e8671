// Problems for tests of optimizers, made of a function.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// One objective, no constraints.
class TestProblem : public Problem {
 public:
  explicit TestProblem(std::vector<DecisionVariable> variables) {
    description_.name = "function";
    description_.variables = std::move(variables);
    description_.objectives = {{"f", ""}};
    description_.cost_unit = "function evaluation";
  }

  const ProblemDescription& description() const override { return description_; }
  std::vector<double> penalty_objectives() const override { return {1e12}; }

 protected:
  ProblemDescription description_;
};

// A function of the decision vector and the case number; the objective is its mean.
class FunctionProblem : public TestProblem {
 public:
  using Function = std::function<double(std::span<const double>, std::uint64_t)>;

  FunctionProblem(std::vector<DecisionVariable> variables, Function function)
      : TestProblem(std::move(variables)), function_(std::move(function)) {}

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      outcomes[i].error = function_(jobs[i].x, jobs[i].number);
    }
    return outcomes;
  }

  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    double sum = 0;
    for (const CaseOutcome& outcome : outcomes) {
      evaluation.case_errors.push_back(outcome.error);
      sum += outcome.error;
    }
    evaluation.objectives = {sum / static_cast<double>(outcomes.size())};
    return evaluation;
  }

 private:
  Function function_;
};

// A sum of squares.
class ResidualProblem : public TestProblem {
 public:
  using Residuals = std::function<std::vector<double>(std::span<const double>)>;

  ResidualProblem(std::vector<DecisionVariable> variables, Residuals residuals)
      : TestProblem(std::move(variables)), residuals_(std::move(residuals)) {
    description_.has_residuals = true;
  }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      outcomes[i].residuals = residuals_(jobs[i].x);
    }
    return outcomes;
  }

  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    double sum = 0;
    for (const double residual : outcomes[0].residuals) {
      sum += residual * residual;
    }
    evaluation.objectives = {sum};
    evaluation.residuals = outcomes[0].residuals;
    return evaluation;
  }

 private:
  Residuals residuals_;
};

// The same with a Jacobian, a row a residual, row after row.
class JacobianProblem : public ResidualProblem {
 public:
  JacobianProblem(std::vector<DecisionVariable> variables, Residuals residuals, Residuals jacobian)
      : ResidualProblem(std::move(variables), std::move(residuals)),
        jacobian_(std::move(jacobian)) {
    description_.has_jacobian = true;
  }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes = ResidualProblem::simulate(jobs);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (jobs[i].jacobian) {
        outcomes[i].jacobian = jacobian_(jobs[i].x);
      }
    }
    return outcomes;
  }

  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation = ResidualProblem::aggregate(x, outcomes);
    evaluation.jacobian = outcomes[0].jacobian;
    return evaluation;
  }

 private:
  Residuals jacobian_;
};

// A bent bowl over three decades, logarithmic variables of either sign, minimum 0 at (900, -30, 2).
inline std::unique_ptr<Problem> make_log_bowl() {
  return std::make_unique<FunctionProblem>(
      std::vector<DecisionVariable>{{"p", "", 1, 10000, 100, Scale::logarithmic},
                                    {"tau_min", "", -10000, -1, -100, Scale::logarithmic},
                                    {"tau_max", "", 0.1, 1000, 10, Scale::logarithmic}},
      [](std::span<const double> x, std::uint64_t) {
        const double a = std::log(x[0] / 900);
        const double b = std::log(x[1] / -30);
        const double c = std::log(x[2] / 2);
        return a * a + b * b + c * c + 0.5 * std::pow(a + b * b, 2);
      });
}

// Returns a problem whose variables all have the same bounds and start.
inline FunctionProblem make_problem(std::size_t dimension, double start, double lower, double upper,
                                    std::function<double(std::span<const double>)> function) {
  std::vector<DecisionVariable> variables(dimension, {"x", "", lower, upper, start, Scale::linear});
  return {variables, [function](std::span<const double> x, std::uint64_t) { return function(x); }};
}

}  // namespace armwright
