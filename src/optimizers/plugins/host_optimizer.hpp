// Optimizers of a host program that uses this library, for example a class in Python. They can run
// only in that program, which makes their rows. Other programs can read what was recorded of them.
// If a user asks for a run there, a message says where it is possible.
//
// The names begin with the host's language: "python:mine". The descriptions are those of plugins
// (docs/plugin-protocol.md, the message `description`), without the name.
#pragma once

#include <string>
#include <string_view>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

inline constexpr std::string_view kPythonPrefix = "python:";

// Returns whether a name means an optimizer of a host program.
bool is_host_name(std::string_view name);
// Returns a message that says how to run it.
std::string explain_host_optimizer(std::string_view name);

// Makes a row from a recorded description. Its optimizer throws Error{usage} in minimize(). The
// host program replaces the row's `make`. Throws Error{bad_data} if the text is no description.
OptimizerRow read_host_row(const std::string& name, const std::string& description);

}  // namespace armwright
