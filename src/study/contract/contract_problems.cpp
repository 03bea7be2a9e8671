// The small problems on which the contract suite runs optimizers.

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

// A bent bowl in logarithmic variables of either sign, as robots have them, over three decades. Its
// value is the sum of squares of its residuals, with the minimum 0 at (900, -30, 2).
class LogBowl : public Problem {
 public:
  LogBowl() {
    description_.name = "log_bowl";
    description_.variables = {{"p", "", 1, 10000, 100, Scale::logarithmic},
                              {"tau_min", "", -10000, -1, -100, Scale::logarithmic},
                              {"tau_max", "", 0.1, 1000, 10, Scale::logarithmic}};
    description_.objectives = {{"f", ""}};
    description_.cost_unit = "function evaluation";
    description_.has_residuals = true;
  }

  const ProblemDescription& description() const override { return description_; }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      const std::span<const double> x = jobs[i].x;
      const double a = std::log(x[0] / 900);
      const double b = std::log(x[1] / -30);
      const double c = std::log(x[2] / 2);
      outcomes[i].residuals = {a, b, c, std::sqrt(0.5) * (a + b * b)};
      for (const double r : outcomes[i].residuals) {
        outcomes[i].error += r * r;
      }
    }
    return outcomes;
  }

  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    evaluation.objectives = {outcomes.front().error};
    evaluation.case_errors = {outcomes.front().error};
    evaluation.residuals = outcomes.front().residuals;
    return evaluation;
  }

  std::vector<double> penalty_objectives() const override { return {1e12}; }

 private:
  ProblemDescription description_;
};

// ZDT1 of Zitzler, Deb and Thiele 2000, Comparison of multiobjective evolutionary algorithms, in
// six variables: the front is f2 = 1 - sqrt(f1), where all variables but the first are 0.
class Zdt1 : public Problem {
 public:
  Zdt1() {
    description_.name = "zdt1";
    for (int i = 1; i <= 6; ++i) {
      description_.variables.push_back({"x" + std::to_string(i), "", 0, 1, 0.5, Scale::linear});
    }
    description_.objectives = {{"f1", ""}, {"f2", ""}};
    description_.objective_weights = {1, 1};
    description_.cost_unit = "function evaluation";
  }

  const ProblemDescription& description() const override { return description_; }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    return std::vector<CaseOutcome>(jobs.size());
  }

  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> /*outcomes*/) const override {
    double sum = 0;
    for (const double xi : x.subspan(1)) {
      sum += xi;
    }
    const double g = 1 + 9 * sum / static_cast<double>(x.size() - 1);
    Evaluation evaluation;
    evaluation.objectives = {x[0], g * (1 - std::sqrt(x[0] / g))};
    evaluation.case_errors = {0};
    return evaluation;
  }

  std::vector<double> penalty_objectives() const override { return {1e6, 1e6}; }

 private:
  ProblemDescription description_;
};

// A bowl in one variable of each type and scale, with the minimum 0 at (medium, 0.3, 7, 90). Its two
// objectives are sums of squares of its residuals, so that it suits every optimizer. It refuses
// values that are not of their variable's type.
class MixedBowl : public Problem {
 public:
  MixedBowl() {
    description_.name = "mixed_bowl";
    // A discrete variable comes first, because pagmo wants them last.
    description_.variables = {
        {"oil",
         "",
         0,
         4,
         0,
         Scale::linear,
         VariableType::category,
         {"thin", "light", "medium", "heavy", "thick"}},
        {"gain", "", -5, 5, -2, Scale::linear},
        {"teeth", "", -9, 30, 20, Scale::linear, VariableType::integer},
        {"turns", "", 1, 2000, 10, Scale::logarithmic, VariableType::integer}};
    description_.objectives = {{"f1", ""}, {"f2", ""}};
    description_.objective_weights = {1, 1};
    description_.cost_unit = "function evaluation";
    description_.has_residuals = true;
  }

  const ProblemDescription& description() const override { return description_; }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      const std::span<const double> x = jobs[i].x;
      require_types(x);
      outcomes[i].residuals = {x[0] == 2 ? 0.0 : 1 + 0.1 * x[0], x[1] - 0.3, 0.2 * (x[2] - 7),
                               std::log(x[3] / 90)};
      for (const double r : outcomes[i].residuals) {
        outcomes[i].error += r * r;
      }
    }
    return outcomes;
  }

  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    const std::vector<double>& r = outcomes.front().residuals;
    Evaluation evaluation;
    evaluation.objectives = {r[0] * r[0] + r[1] * r[1], r[2] * r[2] + r[3] * r[3]};
    evaluation.case_errors = {outcomes.front().error};
    evaluation.residuals = r;
    return evaluation;
  }

  std::vector<double> penalty_objectives() const override { return {1e12, 1e12}; }

 private:
  void require_types(std::span<const double> x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const DecisionVariable& variable = description_.variables[i];
      if (settle_value(variable, x[i]) != x[i]) {
        throw std::logic_error(fmt::format("the problem was asked for {} = {}, which is no {}",
                                           variable.name, x[i], to_string(variable.type)));
      }
    }
  }

  ProblemDescription description_;
};

}  // namespace

std::vector<std::shared_ptr<const Problem>> make_contract_problems(const OptimizerRow& row) {
  std::vector<std::shared_ptr<const Problem>> problems;
  // The other functions demand nothing else of an optimizer's interface. Those with integers would
  // ask optimizers that round for more than the contract does. One function without constraints is
  // enough for an optimizer that is slow and therefore has a limit of evaluations.
  std::vector<const char*> names = {"sphere", "constrained"};
  if (row.limits.evaluations == 0) {
    names.insert(names.begin() + 1, {"ellipsoid", "rosenbrock", "rastrigin"});
  }
  for (const char* name : names) {
    problems.push_back(make_analytic(name));
  }
  problems.push_back(std::make_shared<LogBowl>());
  problems.push_back(std::make_shared<Zdt1>());
  problems.push_back(std::make_shared<MixedBowl>());
  std::erase_if(problems, [&](const auto& problem) {
    return !explain_unsuitable(row, problem->description()).empty();
  });
  return problems;
}

}  // namespace armwright
