// The problems on which optimizers are tried out: analytic functions, a robot-like one of
// logarithmic variables, one of two objectives.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

struct ContractProblem {
  std::string name;
  std::shared_ptr<const Problem> problem;
};

// All, respectively those that suit the optimizer.
std::vector<ContractProblem> make_contract_problems();
std::vector<ContractProblem> make_contract_problems(const OptimizerRow& row);

// No objective of the two-objective problem exceeds it: the reference point of hypervolumes.
inline constexpr double kLargestObjective = 11;

}  // namespace armwright
