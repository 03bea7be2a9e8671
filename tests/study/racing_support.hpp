// Problems whose races can be computed by hand, problems on which races save cases, and plans.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "sim/tracking/test_case.hpp"
#include "study/run_support.hpp"

namespace armwright {

// The objective is the mean of the errors of the cases. They are never negative, so the errors
// simulated so far give a lower bound.
class MeanProblem : public Problem {
 public:
  using CalcError = std::function<double(std::span<const double> x, const CaseBlock& block,
                                         std::uint64_t number)>;
  MeanProblem(std::size_t variables, CalcError calc_error,
              double failure_error = std::numeric_limits<double>::infinity())
      : calc_error_(std::move(calc_error)) {
    description_.name = "mean";
    description_.failure_error = failure_error;
    for (std::size_t i = 0; i < variables; ++i) {
      description_.variables.push_back(
          {.name = "x_" + std::to_string(i), .unit = "", .lower = -5, .upper = 5, .start = 4});
    }
    description_.objectives = {{"f", ""}};
    description_.cost_unit = "case";
  }
  const ProblemDescription& description() const override { return description_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      outcomes[i].error = calc_error_(jobs[i].x, *jobs[i].block, jobs[i].number);
    }
    return outcomes;
  }
  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    for (const CaseOutcome& outcome : outcomes) {
      evaluation.case_errors.push_back(outcome.error);
    }
    evaluation.objectives = {sum(outcomes) / static_cast<double>(outcomes.size())};
    return evaluation;
  }
  std::optional<double> calc_lower_bound(std::span<const double> /*x*/,
                                         std::span<const CaseOutcome> outcomes,
                                         std::size_t cases) const override {
    return sum(outcomes) / static_cast<double>(cases);
  }
  std::vector<double> penalty_objectives() const override { return {1e6}; }

 private:
  static double sum(std::span<const CaseOutcome> outcomes) {
    return std::accumulate(outcomes.begin(), outcomes.end(), 0.0,
                           [](double s, const CaseOutcome& one) { return s + one.error; });
  }
  ProblemDescription description_;
  CalcError calc_error_;
};

// Returns a bowl in `variables` dimensions. Its centre is normally distributed over the cases with
// standard deviation `noise`, so the minimiser of the mean is close to 1 in every coordinate. A few
// cases suffice to tell good designs from bad ones.
inline std::shared_ptr<const Problem> make_noisy_bowl(std::size_t variables, double noise) {
  return std::make_shared<MeanProblem>(
      variables, [noise](std::span<const double> x, const CaseBlock& block, std::uint64_t number) {
        RandomStream random("noisy-bowl/" + block.set, number);
        double error = 0;
        for (const double xi : x) {
          const double off = xi - 1 - noise * random.normal();
          error += off * off;
        }
        return error;
      });
}

inline RunPlan make_mean_plan(std::shared_ptr<const Problem> problem, const std::string& optimizer,
                              std::int64_t budget, const std::string& schedule,
                              const std::string& racing,
                              const std::vector<std::string>& options = {}) {
  RunPlan plan;
  plan.problem.name = "mean";
  plan.problem.problem = std::move(problem);
  plan.problem.resolved_json = "{}";
  plan.problem.sets.validation_cases = 5;
  plan.problem.sets.test_cases = 5;
  plan.optimizer = load_optimizer(optimizer);
  plan.options = Options::parse(optimizer, plan.optimizer.options, options);
  plan.budget = budget;
  plan.schedule = *read_schedule(schedule);
  plan.racing = *read_racing(racing);
  return plan;
}

}  // namespace armwright
