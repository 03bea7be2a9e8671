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

// Returns the problem of a shared library. Without a recorded description, a child opens the library
// once to describe it. Throws Error{usage} if there is no such file, Error{bad_data} if it is no
// problem or if `recorded` is no description.
UserProgram make_library_problem(const std::string& name, const ServerLimits& limits,
                                 const std::string& recorded = "");

}  // namespace armwright
