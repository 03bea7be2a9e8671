// Calls a plugin's minimize() (include/armwright/plugin.h) with an Evaluator behind the function
// pointers of the C interface. No exception crosses this interface: exceptions of our side are held
// until the plugin has returned.
#pragma once

#include <cstdint>

#include "armwright/plugin.h"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Throws ChildFailure if the plugin throws, returns a failure, or reads an option that it has not
// declared. Throws every exception of the evaluator.
void call_plugin(const struct armwright_plugin& plugin, const Options& options,
                 Evaluator& evaluator, std::uint64_t seed);

}  // namespace armwright
