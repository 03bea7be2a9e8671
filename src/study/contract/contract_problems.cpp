// The small problems on which the contract suite runs optimizers.

#include <cmath>

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

}  // namespace

std::vector<std::shared_ptr<const Problem>> make_contract_problems(const OptimizerRow& row) {
  std::vector<std::shared_ptr<const Problem>> problems;
  for (const AnalyticFunction& function : analytic_table()) {
    // BBOB's functions demand nothing else of an optimizer's interface. The functions with integers
    // would ask optimizers that round for more than the contract does.
    if (function.bbob == 0 && !function.has_integers) {
      problems.push_back(make_analytic(function.name));
    }
  }
  problems.push_back(std::make_shared<LogBowl>());
  problems.push_back(std::make_shared<Zdt1>());
  std::erase_if(problems, [&](const auto& problem) {
    return !explain_unsuitable(row, problem->description()).empty();
  });
  return problems;
}

}  // namespace armwright
