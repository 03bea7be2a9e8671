// The bridge between the rows of pagmo.cpp and the library pagmo 2.18: everything that knows
// pagmo's types lies behind these functions.
#pragma once

#include <memory>
#include <string>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// What the bridge must know of a method beside its options. A method with an option `population`
// draws its first population around the start; one without works on the start alone.
struct PagmoMethod {
  std::string row = {};          // the optimizer's name in messages: "pagmo:de"
  std::string algorithm = {};    // pagmo's name for it: "de"
  bool batch = false;            // evaluates generations whole, through pagmo's batch evaluator
  bool constraints = false;      // sees the constraints themselves, not a penalty for them
  bool multi_objective = false;  // sees every objective, not their weighted sum
  bool paced = false;            // its schedule needs to know how many evaluations there will be
  bool ends = false;             // once converged it would only repeat itself
};

// Why the methods cannot be used in this build; empty if they can.
std::string explain_missing_pagmo();

// Error{usage} if pagmo refuses the options.
std::unique_ptr<Optimizer> make_pagmo_optimizer(const PagmoMethod& method, const Options& options);

}  // namespace armwright
