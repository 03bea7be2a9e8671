// Descriptions of optimizers, made from the rows of their table. The functions of the first part
// serve the terminal and the documentation. Those of the second part return the Markdown that
// scripts/docs writes to docs/optimizers. It says nothing about the build, so that every build
// writes the same.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "optimizers/interface/capability_table.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the names of the capabilities that it has, in the order of the table.
std::vector<std::string> list_capabilities(const Capabilities& capabilities);
// Returns what it means for a user that the optimizer has the capability, or that it does not.
std::string describe_capability(const OptimizerRow& row, const CapabilityRow& capability);
// Returns what the problem must offer, for example "at least 2 objectives". The list is empty if
// the optimizer accepts every problem.
std::vector<std::string> list_requirements(const OptimizerRow& row);
// Returns in which process the optimizer runs, as the end of a sentence that begins with "it runs".
std::string describe_isolation(const OptimizerRow& row);
// Returns "true or false", "integer", "number" or "text".
const char* get_option_type(const OptionValue& value);
// Returns a number's range, "2 to 100000". The result is empty for other types.
std::string describe_range(const OptionSpec& option);

// Returns the name of the optimizer's page: "nlopt:cobyla" -> "nlopt-cobyla.md".
std::string get_page_name(const std::string& optimizer);
// Returns a table of all optimizers with links to their pages. scripts/docs reads names and files
// from it: a row begins with | [`NAME`](FILE) |
std::string format_optimizer_index(std::span<const OptimizerRow> rows);
std::string format_optimizer_page(const OptimizerRow& row);

}  // namespace armwright
