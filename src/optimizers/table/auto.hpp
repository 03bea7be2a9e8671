// The optimizer `auto` chooses another one by rules (auto_rules.hpp) and runs it. The choice depends
// on the problem, the budget and the schedule, and on neither time, machine nor threads.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

inline constexpr const char* kAutoName = "auto";

std::vector<OptimizerRow> make_auto_rows();

}  // namespace armwright
