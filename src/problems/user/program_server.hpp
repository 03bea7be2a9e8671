// Problems that are programs in any language. They exchange lines of JSON with armwright over
// standard input and output (docs/problem-protocol.md).
#pragma once

#include <string>
#include <string_view>

#include "problems/user/case_server.hpp"

namespace armwright {

// Returns the problem of a program. `command` is the text after "exec:"; it is split into words as
// by a shell, but no shell runs. Without a recorded description the program is started once to
// describe itself. Throws Error{usage} if there is no such program, Error{bad_data} if it breaks the
// protocol or if `recorded` is no description.
UserProgram make_program_problem(std::string_view command, const ServerLimits& limits,
                                 const std::string& recorded = "");

}  // namespace armwright
