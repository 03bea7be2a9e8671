// Checks the requests of an optimizer that nothing disturbs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/contract/contract_checks.hpp"

namespace armwright {

ContractFinding check_budget(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    for (const std::int64_t budget : {1, 2, 36, 137}) {
      const MemoryEvaluator evaluator = trial.run({.budget = budget});
      if (evaluator.trace().empty()) {
        return fmt::format("a budget of {} led to no evaluation at all", budget);
      }
      if (evaluator.calls_after_stop() > 1) {
        return fmt::format("with a budget of {} it went on asking {} times after the end", budget,
                           evaluator.calls_after_stop());
      }
    }
    return "";
  });
}

ContractFinding check_zero_budget(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [](const ContractTrial& trial) {
    const MemoryEvaluator evaluator = trial.run({.budget = 0});
    return evaluator.calls_after_stop() > 1 ? "it goes on asking without a budget" : "";
  });
}

ContractFinding check_beginning(const OptimizerRow& row, const Options& options) {
  if (row.capabilities.paced) {
    return make_exempt("it divides the budget up beforehand");
  }
  return check_on_all(row, options, [](const ContractTrial& trial) -> std::string {
    const MemoryEvaluator small = trial.run({.budget = 90});
    const MemoryEvaluator large = trial.run({.budget = 300});
    if (small.trace().size() > large.trace().size()) {
      return "a larger budget led to fewer evaluations";
    }
    for (std::size_t i = 0; i < small.trace().size(); ++i) {
      if (small.trace()[i].evaluated != large.trace()[i].evaluated) {
        return fmt::format("evaluation {} depends on the budget; declare 'paced' if it must", i);
      }
    }
    return "";
  });
}

ContractFinding check_points(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    const MemoryEvaluator evaluator = trial.run({.budget = 600});
    for (std::size_t i = 0; i < evaluator.trace().size(); ++i) {
      const MemoryEvaluator::Entry& entry = evaluator.trace()[i];
      if (!std::ranges::all_of(entry.asked, [](double v) { return std::isfinite(v); })) {
        return fmt::format("evaluation {} asks for a coordinate that is no finite number", i);
      }
      if (row.capabilities.bounds && entry.score.clipped) {
        return fmt::format("evaluation {} lies outside the bounds, though it declares 'bounds'", i);
      }
    }
    return "";
  });
}

ContractFinding check_types(const OptimizerRow& row, const Options& options) {
  if (!row.capabilities.integer && !row.capabilities.categorical) {
    return make_exempt("it declares neither 'integer' nor 'categorical': its points are rounded");
  }
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    const MemoryEvaluator evaluator = trial.run({.budget = 600});
    const std::vector<DecisionVariable>& variables = evaluator.problem().variables;
    for (std::size_t i = 0; i < evaluator.trace().size(); ++i) {
      const std::vector<double>& asked = evaluator.trace()[i].asked;
      for (std::size_t k = 0; k < asked.size(); ++k) {
        if (variables[k].type != VariableType::real && asked[k] != std::round(asked[k])) {
          return fmt::format(
              "evaluation {} asks for {} = {}, and it declares '{}'", i, variables[k].name,
              asked[k], variables[k].type == VariableType::integer ? "integer" : "categorical");
        }
      }
    }
    return "";
  });
}

ContractFinding check_batches(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
    const MemoryEvaluator evaluator = trial.run({.budget = 200});
    const bool has_batches =
        std::ranges::any_of(evaluator.batch_sizes(), [](std::size_t size) { return size > 1; });
    if (has_batches != row.capabilities.batch) {
      return has_batches ? "it asks for batches, though it does not declare 'batch'"
                         : "it asks for one point at a time, though it declares 'batch'";
    }
    if ((evaluator.generations() > 0) != row.capabilities.generations) {
      return row.capabilities.generations ? "it declares 'generations' and begins none"
                                          : "it begins generations without declaring them";
    }
    return "";
  });
}

ContractFinding check_repeatable(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [](const ContractTrial& trial) {
    return describe_difference(trial.run({.budget = 400}, 3).trace(),
                               trial.run({.budget = 400}, 3).trace());
  });
}

// Some optimizers draw random numbers in some situations only, so it is enough if the seed matters
// on one problem.
ContractFinding check_seed(const OptimizerRow& row, const Options& options) {
  bool matters = false;
  const ContractFinding finding =
      check_on_all(row, options, [&](const ContractTrial& trial) -> std::string {
        const bool differ =
            trial.run({.budget = 400}, 0).trace() != trial.run({.budget = 400}, 1).trace();
        matters = matters || differ;
        return differ && !row.capabilities.stochastic
                   ? "seeds 0 and 1 give different runs, though it does not declare 'stochastic'"
                   : "";
      });
  if (finding.outcome == ContractOutcome::held && row.capabilities.stochastic && !matters) {
    return make_broken("seeds 0 and 1 give the same run, though it declares 'stochastic'");
  }
  return finding;
}

ContractFinding check_memory_between_runs(const OptimizerRow& row, const Options& options) {
  return check_on_all(row, options, [&](const ContractTrial& trial) {
    const auto optimizer = row.make(options);
    MemoryEvaluator first = trial.make_evaluator({.budget = 200});
    MemoryEvaluator second = trial.make_evaluator({.budget = 200});
    optimizer->minimize(first, 3);
    optimizer->minimize(second, 3);
    return describe_difference(first.trace(), second.trace());
  });
}

}  // namespace armwright
