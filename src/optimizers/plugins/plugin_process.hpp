// Optimizers that are programs of their own, in any language: lines of JSON over standard input and
// output, ask and tell. docs/plugin-protocol.md is the protocol.
#pragma once

#include <string_view>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// The version of the protocol that this program speaks.
inline constexpr int kPluginProtocol = 1;

// `command` is what stands behind "exec:", split as a shell would, but no shell runs. The program
// is started once to describe itself, and again for every minimize(). Error{usage} if there is no
// such program, Error{bad_data} if it does not describe itself as the protocol wants it.
// `loading_s`: how long it may take to describe itself, each time: interpreters and their libraries
// load slowly.
OptimizerRow load_process_plugin(std::string_view command, double loading_s = 60);

}  // namespace armwright
