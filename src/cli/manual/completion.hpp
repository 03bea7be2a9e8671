// Completion: the values that each flag and argument can take, and the script for bash.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/manual/command_definition.hpp"

namespace armwright {

// The places that the values of one flag or argument come from. If all are empty, the program
// cannot know the values, for example those of a number.
struct ValueSource {
  std::vector<std::string> choices = {};  // fixed values
  std::string list = {};   // a kind whose names 'armwright list KIND --names' prints, or one of the
                           // constants below
  bool files = false;      // names of files
  bool folders = false;    // names of folders
  bool separated = false;  // whether several values can be given, separated by commas
};

// Values of ValueSource::list that are no kind of 'armwright list'.
inline constexpr const char* kListOfFirstArgument = "@1";  // the kind that the first argument names
inline constexpr const char* kListOfCommands = "@commands";  // the subcommands of the words before

// Returns the source of the argument's values, or nothing if the tables do not have the argument. A
// test demands that the tables have all arguments.
std::optional<ValueSource> find_value_source(const CommandDefinition& command,
                                             const ArgumentDefinition& argument);

// Returns a script that completes commands and flags by itself. For names of problems, optimizers
// and so on the script calls the program.
std::string make_bash_completion(const CommandDefinition& program, const std::string& version);

}  // namespace armwright
