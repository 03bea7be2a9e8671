// The explicit table of the shipped optimizers, and how a name on the command line becomes an optimizer.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Why the optimizer cannot work on the problem; empty if it can.
std::string explain_unsuitable(const OptimizerRow& row, const ProblemDescription& problem);

const std::vector<OptimizerRow>& optimizer_table();
std::vector<std::string> optimizer_names();
const OptimizerRow& find_optimizer(std::string_view name);  // Error{usage} if there is none

// What stands behind `--optimizer`: a name of the table, multistart:NAME, a shared library
// (./libmine.so, or its name on the plugin path) or a process (exec:COMMAND). Error{usage} or
// Error{bad_data} if there is none or it cannot be used.
OptimizerRow load_optimizer(std::string_view name);

}  // namespace armwright
