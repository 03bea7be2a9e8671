// What every optimizer must do, whatever it is: never more than the budget, the same with the same
// seed, stop when told to, survive failing evaluations, resume by replay, leave nothing behind. One
// suite for all: the tests run it over the whole table, `armwright check-plugin` over a user's own.
#pragma once

#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

enum class ContractOutcome { held, broken, exempt };

struct ContractFinding {
  ContractOutcome outcome = ContractOutcome::held;
  std::string detail;  // broken: on which problem and how; exempt: why
};

struct ContractCheck {
  const char* name;     // one word for tests: "Budget"
  const char* promise;  // "asks for no more evaluations than the budget allows"
  ContractFinding (*run)(const OptimizerRow& row, const Options& options);
};

const std::vector<ContractCheck>& contract_checks();

// Runs one check; an exception that comes out of the optimizer breaks it.
ContractFinding run_contract_check(const ContractCheck& check, const OptimizerRow& row,
                                   const Options& options);

}  // namespace armwright
