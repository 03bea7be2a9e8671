// Optimizers that are programs, in any language. They exchange lines of JSON with armwright over
// standard input and output, by the protocol of docs/plugin-protocol.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// The version of the protocol that this program speaks.
inline constexpr int kPluginProtocol = 1;

// Returns the row of a program. `command` is the text after "exec:"; it is split into words as by a
// shell, but no shell runs. The program is started once to describe itself, and once for every
// minimize(). `loading_s` is the longest time for each start until the description arrives;
// interpreters and their libraries load slowly. Throws Error{usage} if there is no such program,
// and Error{bad_data} if its description breaks the protocol.
OptimizerRow load_process_plugin(std::string_view command, double loading_s = 60);

}  // namespace armwright
