// Connects the rows of pagmo.cpp with the library pagmo 2.18. All code that needs types of pagmo
// lies behind these functions.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns one row per algorithm of pagmo. In a build without pagmo they say so and cannot be used.
std::vector<OptimizerRow> make_pagmo_rows();

// The properties of a method besides its options. A method with an option `population` draws its
// first population around the start. A method without it works on the start alone.
struct PagmoMethod {
  std::string row = {};          // the optimizer's name in messages: "pagmo:de"
  std::string algorithm = {};    // pagmo's name for it: "de"
  bool batch = false;            // evaluates whole generations through pagmo's batch evaluator
  bool constraints = false;      // handles constraints; otherwise they become a penalty
  bool multi_objective = false;  // handles every objective; otherwise their weighted sum counts
  bool paced = false;            // its schedule needs the number of evaluations
  bool ends = false;             // it ends when it has converged; it would only repeat itself
  bool integer = false;          // it keeps integers whole; the others would propose fractions
};

// Returns why this build cannot use the methods; empty if it can.
std::string explain_missing_pagmo();

// Makes the optimizer. Throws Error{usage} if pagmo refuses the options.
std::unique_ptr<Optimizer> make_pagmo_optimizer(const PagmoMethod& method, const Options& options);

}  // namespace armwright
