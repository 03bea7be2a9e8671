// One candidate's evaluation as a journal (study/journal.hpp) keeps it.
#pragma once

#include <cstdint>
#include <vector>

#include "optimizers/interface/evaluator.hpp"
#include "problems/interface/problem.hpp"

namespace armwright {

// As asked for and as answered.
struct EvaluationRecord {
  // In cases of the budget.
  std::uint64_t calc_charge() const {
    return cases.numbers.size() *
           (with_jacobian ? static_cast<std::uint64_t>(calc_jacobian_charge(x.size())) : 1);
  }

  std::uint64_t index = 0;       // place among the evaluations of its role, from 0
  std::uint64_t generation = 0;  // 0 for optimizers without generations
  std::vector<double> x;         // as evaluated, inside the bounds
  bool clipped = false;          // the optimizer had asked for a point outside
  bool with_jacobian = false;    // asked for with exact derivatives
  CaseBlock cases;
  Evaluation evaluation;
};

}  // namespace armwright
