// The explicit table of the shipped optimizers, and how a name on the command line becomes an
// optimizer.
#pragma once

#include <span>
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
// Error{usage} if there is none of that name, and Error{bad_data} if a plugin cannot be used. Of an
// unavailable optimizer, making it throws Error{usage}.
OptimizerRow load_optimizer(std::string_view name);

// Returns whether load_optimizer() would start a program or open a library. Starts and opens
// nothing.
bool is_plugin(std::string_view name);
// Returns the files that decide what a plugin does: its library, or the words of its command that
// are files. Starts and opens nothing. Throws Error{usage} if the command cannot be split.
std::vector<std::string> list_plugin_files(std::string_view name);
// Makes the row of a plugin from what a study recorded: its description, which version 1.0 did not
// record, and the KEY=VALUE texts of its options. Starts and opens nothing. Its optimizer throws
// Error{usage} in minimize(). Throws Error{bad_data} if the description is none, and
// Error{usage} if the name is not printable.
OptimizerRow read_recorded_plugin(const std::string& name, const std::string& description,
                                  std::span<const std::string> options);

}  // namespace armwright
