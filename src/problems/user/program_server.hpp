// Problems that are programs in any language. They exchange lines of JSON with armwright over
// standard input and output (docs/problem-protocol.md).
#pragma once

#include <string>
#include <string_view>

#include "problems/user/case_server.hpp"

namespace armwright {

// Returns the description of a program, which is started once to describe itself. `command` is the text
// after "exec:"; it is split into words as by a shell, but no shell runs. Throws Error{usage} if
// there is no such program, Error{bad_data} if it breaks the protocol.
UserDescription describe_program(std::string_view command);

// Returns a function that starts the program as a server. The function throws Error{bad_data} if
// the program describes itself in another way than `description`.
StartServer make_program_start(std::string_view command, const ServerLimits& limits,
                               const UserDescription& description);

}  // namespace armwright
