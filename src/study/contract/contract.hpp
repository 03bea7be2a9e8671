// The contract of optimizers: what every optimizer must do. It keeps the budget, gives the same
// result with the same seed, stops when told to, survives failing evaluations, resumes by replay,
// and leaves nothing behind. The tests run this suite over all optimizers of the table, and
// `armwright check-plugin` over a user's own one.
#pragma once

#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

enum class ContractOutcome {
  held,
  broken,
  exempt  // the optimizer declares that the promise does not apply to it
};

struct ContractFinding {
  ContractOutcome outcome = ContractOutcome::held;
  std::string detail;  // broken: on which problem and how; exempt: why
  bool ends = false;   // the checks that follow would find the same fault
};

struct ContractCheck {
  const char* name;     // one word for tests: "Budget"
  const char* promise;  // "asks for no more than the budget allows"
  ContractFinding (*run)(const OptimizerRow& row, const Options& options);
};

const std::vector<ContractCheck>& contract_checks();

// Runs one check. An exception that the optimizer throws counts as `broken`.
ContractFinding run_contract_check(const ContractCheck& check, const OptimizerRow& row,
                                   const Options& options);

}  // namespace armwright
