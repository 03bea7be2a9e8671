// Which variables of a run matter, as text.
#pragma once

#include <string>

#include "cli/terminal/terminal.hpp"
#include "study/analysis/importance.hpp"

namespace armwright {

// Returns one table per part, headed by how far its numbers can be trusted.
std::string describe_importance(const Importance& importance, const Style& style);

}  // namespace armwright
