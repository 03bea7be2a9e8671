// What the values of flags and arguments can be, as far as the program knows: for completion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/manual/command_definition.hpp"

namespace armwright {

struct ValueSource {
  std::vector<std::string> choices = {};  // these,
  std::string list = {};                  // what 'armwright list LIST --names' prints,
  bool files = false;                     // and files
  bool folders = false;                   // or folders
  bool separated = false;                 // several, with commas between them
};

// Neither names nor files for what nobody can guess, as a number. Nothing if the tables do not know
// the argument: a test demands that they know all.
std::optional<ValueSource> find_value_source(const CommandDefinition& command,
                                             const ArgumentDefinition& argument);

// Values of ValueSource::list beside the kinds that 'armwright list' knows.
inline constexpr const char* kListOfFirstArgument = "@1";  // the kind that the first argument names
inline constexpr const char* kListOfCommands = "@commands";  // the commands below those that stand
                                                             // in front

}  // namespace armwright
