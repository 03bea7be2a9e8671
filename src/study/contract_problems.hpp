// The problems on which optimizers are tried out: analytic functions, a robot-like one of
// logarithmic variables, one of two objectives.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "optimizers/optimizer.hpp"

namespace armwright {

struct ContractProblem {
  std::string name;
  std::shared_ptr<const Problem> problem;
};

// All, respectively those that suit the optimizer.
std::vector<ContractProblem> make_contract_problems();
std::vector<ContractProblem> make_contract_problems(const OptimizerRow& row);

// The area between a front of two objectives and the point (11, 11), which no objective of the
// two-objective problem exceeds; larger is better (Zitzler and Thiele 1998, hypervolume).
double calc_hypervolume(std::vector<std::vector<double>> objectives);

}  // namespace armwright
