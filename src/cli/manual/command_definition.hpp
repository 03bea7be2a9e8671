// The program's commands as data. They are read from the parser that runs the commands, so that
// manual pages, completion and the reference page agree with the program.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace armwright {

// A flag, or a positional argument.
struct ArgumentDefinition {
  std::string name;                      // of a positional argument: "PROBLEM"; otherwise empty
  std::vector<std::string> long_names;   // "--optimizer"
  std::vector<std::string> short_names;  // "-o"
  std::string value;                     // the name of a flag's value: "NAME"; empty without one
  bool is_value_optional = false;
  bool is_required = false;
  bool repeats = false;
  std::string group;                  // its heading in --help: "Options", "Output"
  std::string environment;            // the variable that can replace it; empty without one
  std::string description;            // with the line breaks of --help
  std::vector<std::string> excludes;  // flags that cannot be given together with it

  // Returns the name of a positional argument, or the long name of a flag.
  const std::string& get_key() const;
};

// A command, with the commands below it.
struct CommandDefinition {
  std::vector<std::string> words;  // {"armwright", "testset", "export"}
  std::string summary;
  std::string notes;  // the text of --help below the flags; the examples come first
  std::vector<ArgumentDefinition> arguments;
  std::vector<ArgumentDefinition> flags;
  std::vector<CommandDefinition> commands;

  std::string get_title() const;  // "armwright testset export"
};

CommandDefinition describe_command(const CLI::App& app);

// Returns the command with these words. They do not contain the program's own name; without words,
// the result is the program. Throws Error{usage} with the valid names if there is no such command.
const CommandDefinition& find_command(const CommandDefinition& program,
                                      const std::vector<std::string>& words);

// Returns the command and all commands below it; each command comes before those below it.
std::vector<const CommandDefinition*> list_all_commands(const CommandDefinition& command);

}  // namespace armwright
