// The checks of the contract suite, the problems on which they run optimizers, and what they share.
// For use inside the suite and by tests; its interface is contract.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "study/contract/contract.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {

// Returns the problems of the suite that suit the optimizer: the analytic functions, one with
// logarithmic variables like those of robots (log_bowl), one with two objectives (zdt1), and one
// with variables of every type (mixed_bowl).
std::vector<std::shared_ptr<const Problem>> make_contract_problems(const OptimizerRow& row);

// The reference point of hypervolumes: at least as large as every objective of zdt1.
inline constexpr double kLargestObjective = 11;

// Returns the budget with which a check runs the optimizer. Every evaluation costs much time if the
// optimizer has a limit of evaluations; a fortieth of the limit is then enough.
inline std::int64_t limit_budget(const OptimizerRow& row, std::int64_t budget) {
  const std::int64_t most = row.limits.evaluations / 40;
  return most > 0 ? std::min(budget, most) : budget;
}

// One optimizer on one problem.
struct ContractTrial {
  const OptimizerRow& row;
  const Options& options;
  const Problem& problem;

  // Returns an evaluator that gives the optimizer the variables as it can treat them.
  MemoryEvaluator make_evaluator(MemoryEvaluatorSettings settings) const {
    settings.budget = limit_budget(row, settings.budget);
    settings.capabilities = row.capabilities;
    return {problem, settings};
  }
  // Runs a new optimizer once and returns its evaluator.
  MemoryEvaluator run(const MemoryEvaluatorSettings& settings, std::uint64_t seed = 1) const;
};

ContractFinding make_broken(std::string detail);
ContractFinding make_exempt(std::string why);

// Calls `find_fault` for every problem that suits the optimizer, and returns the first fault. An
// empty text means that there is none.
ContractFinding check_on_all(const OptimizerRow& row, const Options& options,
                             const std::function<std::string(const ContractTrial&)>& find_fault);

// Returns the first difference of two traces as text; empty if they are the same.
std::string describe_difference(const std::vector<MemoryEvaluator::Entry>& a,
                                const std::vector<MemoryEvaluator::Entry>& b);

// The requests of an undisturbed optimizer (contract_requests.cpp).
ContractFinding check_budget(const OptimizerRow& row, const Options& options);
ContractFinding check_zero_budget(const OptimizerRow& row, const Options& options);
ContractFinding check_types(const OptimizerRow& row, const Options& options);
ContractFinding check_points(const OptimizerRow& row, const Options& options);
ContractFinding check_repeatable(const OptimizerRow& row, const Options& options);
ContractFinding check_seed(const OptimizerRow& row, const Options& options);
ContractFinding check_memory_between_runs(const OptimizerRow& row, const Options& options);
ContractFinding check_beginning(const OptimizerRow& row, const Options& options);
ContractFinding check_batches(const OptimizerRow& row, const Options& options);
// The reaction to failures, exceptions and stops (contract_disturbances.cpp).
ContractFinding check_failures(const OptimizerRow& row, const Options& options);
ContractFinding check_exceptions(const OptimizerRow& row, const Options& options);
ContractFinding check_stop(const OptimizerRow& row, const Options& options);
ContractFinding check_resume(const OptimizerRow& row, const Options& options);
// The state after a run, and its result (contract_outcome.cpp).
ContractFinding check_leaks(const OptimizerRow& row, const Options& options);
ContractFinding check_learning(const OptimizerRow& row, const Options& options);
ContractFinding check_constraints(const OptimizerRow& row, const Options& options);

}  // namespace armwright
