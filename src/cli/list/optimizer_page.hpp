// The documentation of optimizers in Markdown, made of the table that the program itself works
// with. scripts/docs writes it to docs/optimizers. It says nothing about this build, so that every
// build writes the same.
#pragma once

#include <span>
#include <string>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// "nlopt:cobyla" -> "nlopt-cobyla.md"
std::string get_page_name(const std::string& optimizer);

// All of them in a table with links to their pages. scripts/docs reads names and files from it: a
// row begins with | [`NAME`](FILE) |
std::string format_optimizer_index(std::span<const OptimizerRow> rows);

std::string format_optimizer_page(const OptimizerRow& row);

}  // namespace armwright
