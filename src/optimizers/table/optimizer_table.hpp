// The explicit table of the shipped optimizers, and how a name on the command line becomes an
// optimizer.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns why the optimizer cannot work on the problem; empty if it can.
std::string explain_unsuitable(const OptimizerRow& row, const ProblemDescription& problem);

// All shipped optimizers, one row each.
const std::vector<OptimizerRow>& optimizer_table();
std::vector<std::string> optimizer_names();
// Returns the row of that name in the table. Throws Error{usage}, with the valid names, if there is
// none.
const OptimizerRow& find_optimizer(std::string_view name);

// Returns the optimizer that `--optimizer NAME` means: a row of the table, multistart:NAME, a
// shared library (./libmine.so, or its name on the plugin path) or a program (exec:COMMAND). Throws
// Error{usage} if there is none of that name, and Error{bad_data} if a plugin cannot be used.
OptimizerRow load_optimizer(std::string_view name);

}  // namespace armwright
