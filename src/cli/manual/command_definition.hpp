// What the program's commands are, as data: read from the parser that runs them, so that manual
// pages, completion and the reference page say what is true.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace armwright {

// A flag, or an argument without one.
struct ArgumentDefinition {
  std::string name;                      // of an argument without flag: "PROBLEM"; else empty
  std::vector<std::string> long_names;   // "--optimizer"
  std::vector<std::string> short_names;  // "-o"
  std::string value;                     // what follows a flag: "NAME"; empty: nothing does
  bool is_value_optional = false;
  bool is_required = false;
  bool repeats = false;
  std::string group;                  // the heading that --help has it under: "Options", "Output"
  std::string environment;            // the variable that stands in for it; empty: none does
  std::string description;            // in lines, as --help has it
  std::vector<std::string> excludes;  // flags that it does not go with

  // The name of an argument, the long name of a flag.
  const std::string& get_key() const;
};

struct CommandDefinition {
  std::vector<std::string> words;  // {"armwright", "testset", "export"}
  std::string summary;
  std::string notes;  // what --help says below the flags: examples first
  std::vector<ArgumentDefinition> arguments;
  std::vector<ArgumentDefinition> flags;
  std::vector<CommandDefinition> commands;

  std::string get_title() const;  // "armwright testset export"
};

CommandDefinition describe_command(const CLI::App& app);

// The command that `words` lead to, without the program's own name; none: the program. Error{usage}
// with the valid ones if there is no such.
const CommandDefinition& find_command(const CommandDefinition& program,
                                      const std::vector<std::string>& words);

// The command itself, then all below it, each before its own.
std::vector<const CommandDefinition*> list_all_commands(const CommandDefinition& command);

}  // namespace armwright
