// The checks of the contract suite, and what they share. Inside the suite only: contract.hpp is its
// door.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/contract/contract.hpp"
#include "study/contract/contract_problems.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {

// One optimizer on one problem.
struct ContractTrial {
  const OptimizerRow& row;
  const Options& options;
  const ContractProblem& problem;

  MemoryEvaluator run(const MemoryEvaluatorSettings& settings, std::uint64_t seed = 1) const;
};

ContractFinding make_broken(std::string detail);
ContractFinding make_exempt(std::string why);

// The first thing that is wrong on any problem that suits the optimizer; an empty text: nothing is.
ContractFinding check_on_all(const OptimizerRow& row, const Options& options,
                             const std::function<std::string(const ContractTrial&)>& find_fault);

// Where two traces part; empty if they are the same.
std::string describe_difference(const std::vector<MemoryEvaluator::Entry>& a,
                                const std::vector<MemoryEvaluator::Entry>& b);

// What it asks for, left alone (contract_requests.cpp).
ContractFinding check_budget(const OptimizerRow& row, const Options& options);
ContractFinding check_zero_budget(const OptimizerRow& row, const Options& options);
ContractFinding check_points(const OptimizerRow& row, const Options& options);
ContractFinding check_repeatable(const OptimizerRow& row, const Options& options);
ContractFinding check_seed(const OptimizerRow& row, const Options& options);
ContractFinding check_memory_between_runs(const OptimizerRow& row, const Options& options);
ContractFinding check_beginning(const OptimizerRow& row, const Options& options);
ContractFinding check_batches(const OptimizerRow& row, const Options& options);
// How it takes what happens to it (contract_disturbances.cpp).
ContractFinding check_failures(const OptimizerRow& row, const Options& options);
ContractFinding check_exceptions(const OptimizerRow& row, const Options& options);
ContractFinding check_stop(const OptimizerRow& row, const Options& options);
ContractFinding check_resume(const OptimizerRow& row, const Options& options);
// What is there afterwards (contract_outcome.cpp).
ContractFinding check_leaks(const OptimizerRow& row, const Options& options);
ContractFinding check_learning(const OptimizerRow& row, const Options& options);
ContractFinding check_constraints(const OptimizerRow& row, const Options& options);

}  // namespace armwright
