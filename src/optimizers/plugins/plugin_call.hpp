// Calls a plugin's minimize() (include/armwright/plugin.h) with an Evaluator of ours behind the
// border's function pointers. No exception crosses the border: what our side throws is held until
// the plugin has returned.
#pragma once

#include <cstdint>

#include "armwright/plugin.h"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Throws ChildFailure if the plugin throws, returns a failure or asks for an option that it has not
// declared, and whatever the evaluator throws.
void call_plugin(const struct armwright_plugin& plugin, const Options& options,
                 Evaluator& evaluator, std::uint64_t seed);

}  // namespace armwright
