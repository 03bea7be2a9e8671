// Reads what a command's --help says below its flags: paragraphs with an empty line between them,
// of which some are lists or have a title.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/manual/manual_page.hpp"

namespace armwright {

// "holds   no more cases fail": a name, at least two blanks, what it is.
struct ListEntry {
  std::string name;
  std::string text;
};
std::optional<ListEntry> read_list_entry(const std::string& line);

struct CommandNotes {
  std::vector<ManualBlock> text;        // what has no title
  std::vector<ManualSection> sections;  // "Examples", "Exit status", "Environment"
};
CommandNotes read_notes(const std::string& notes);

}  // namespace armwright
