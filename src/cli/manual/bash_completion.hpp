// Completion for bash: a script that knows all commands and flags, and asks the program for the
// names of problems, optimizers, ...
#pragma once

#include <string>

#include "cli/manual/command_definition.hpp"

namespace armwright {

std::string make_bash_completion(const CommandDefinition& program, const std::string& version);

}  // namespace armwright
