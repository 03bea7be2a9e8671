// Problems in shared libraries (include/armwright/problem.h). Only forked children open the
// library. Questions and answers are packets of numbers (process/packet.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "problems/user/case_server.hpp"

namespace armwright {

// Returns whether a problem's name means a shared library: it ends in ".so", or it has a slash and
// is a file that begins as libraries do.
bool is_problem_library(std::string_view name);

// Returns the description of the problem in a shared library, which a child opens. Throws
// Error{usage} if there is no such file, Error{bad_data} if it is no problem.
UserDescription describe_library(const std::string& name, const ServerLimits& limits);

// Returns a function that starts a child with the library as a server. The function throws
// Error{usage} if there is no such file, Error{bad_data} if the library has changed or describes
// itself in another way than `description`.
StartServer make_library_start(const std::string& name, const ServerLimits& limits,
                               const UserDescription& description);

}  // namespace armwright
