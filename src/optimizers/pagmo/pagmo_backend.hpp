// Connects the rows of pagmo.cpp with the library pagmo 2.18, which only the module
// libarmwright_pagmo.so contains (optimizers/pagmo_module). The module is loaded when an optimizer
// is made (process/module_loader.hpp).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns one row per algorithm of pagmo. Without pagmo or its module they say so and cannot be
// used.
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

// Loads the module and makes the optimizer. Throws Error{usage} if pagmo refuses the options, and
// Error{bad_data} if the module cannot be loaded or belongs to another build.
std::unique_ptr<Optimizer> make_pagmo_optimizer(const PagmoMethod& method, const Options& options);

}  // namespace armwright
