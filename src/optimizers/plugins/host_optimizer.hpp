// Optimizers that live in a program that uses this library, as a class of Python's does, and can
// run only there. Such a program makes rows of them itself; everywhere else what was recorded of
// them can be read, and asking for a run says where to.
//
// Their names begin with what they are written in: "python:mine". They describe themselves as
// plugins do (docs/plugin-protocol.md, the message `description`), but for the name.
#pragma once

#include <string>
#include <string_view>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

inline constexpr std::string_view kPythonPrefix = "python:";

bool is_foreign_name(std::string_view name);
// What to do instead of running it here.
std::string explain_foreign(std::string_view name);

// The row of a recorded description: an optimizer made of it refuses to minimize with Error{usage}.
// Who can run it puts another `make` into the row. Error{bad_data} if it is no description.
OptimizerRow read_foreign_row(const std::string& name, const std::string& description);

}  // namespace armwright
