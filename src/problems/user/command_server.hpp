// Problems that are a command per case, for simulators that read files and write files. Each case
// has a working folder of its own, in which the command's input files are written and its results
// are read (docs/problems.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "problems/user/case_server.hpp"
#include "problems/user/result_reading.hpp"

namespace armwright {

// A text in which "{NAME}" stands for a value of the case, and "{{" for a brace.
class Template {
 public:
  // Throws std::invalid_argument, whose message completes "it must ...", if the text has a place
  // for none of `names` or a brace that is not closed.
  Template(std::string_view text, const std::vector<std::string>& names);
  // Puts the values, one per name, into their places.
  std::string fill(const std::vector<std::string>& values) const;
  // Returns whether the text has a place for the name with this number.
  bool uses(std::size_t name) const;

 private:
  struct Part {
    std::string text;                 // before the place
    std::optional<std::size_t> name;  // nothing at the end of the template
  };
  std::vector<Part> parts_;
};

// The names of places in the templates of a command: the variables, and what describes the case.
std::vector<std::string> list_places(const std::vector<DecisionVariable>& variables);

enum class KeepFolders : std::uint8_t { none, failed, all };

struct CommandPlan {
  struct Input {
    std::string file;  // a plain file name
    Template text;
  };
  std::string name;  // the command as the user typed it
  UserDescription description;
  std::vector<Template> words;
  std::vector<Input> inputs;
  // How each number is read: objectives, constraints, metrics.
  std::vector<ResultReading> readings;
  std::filesystem::path folder;     // the value of {folder}
  std::filesystem::path workspace;  // where working folders are made; empty: for temporary files
  KeepFolders keep = KeepFolders::none;
  ServerLimits limits;
};

// Returns the problem of a command. It starts nothing.
UserProgram make_command_problem(CommandPlan plan);

}  // namespace armwright
