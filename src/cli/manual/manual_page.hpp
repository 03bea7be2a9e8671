// The content of a command's manual page, without its layout. manual_formats.hpp has the layouts.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "cli/manual/command_definition.hpp"

namespace armwright {

// A literal is typed as it is; a placeholder stands for a value.
enum class Emphasis { none, literal, placeholder };

struct Span {
  Emphasis emphasis = Emphasis::none;
  std::string text;
};
using SpanLine = std::vector<Span>;

struct Paragraph {
  std::string text;
};
struct Synopsis {
  SpanLine line;
};
// An item of a list: all names of a thing, its explanation, and perhaps a list within that.
struct ManualItem {
  std::vector<SpanLine> names;
  std::string text;
  std::vector<ManualItem> items;
};
struct Verbatim {
  std::vector<std::string> lines;
};
// Other pages by their titles, for example "armwright testset export". All are in chapter 1.
struct PageReferences {
  std::vector<std::string> titles;
};
using ManualBlock = std::variant<Paragraph, Synopsis, ManualItem, Verbatim, PageReferences>;

struct ManualSection {
  std::string title;  // "Exit status"
  std::vector<ManualBlock> blocks;
};

struct ManualPage {
  std::string name;   // "armwright-testset-export"
  std::string title;  // "armwright testset export"
  std::string summary;
  std::vector<ManualSection> sections;  // those after the name and the summary
};

// Returns the page of `command`. `program` has the commands that the page may refer to.
ManualPage make_manual_page(const CommandDefinition& command, const CommandDefinition& program);

// Returns the name of the page with this title: "armwright testset" -> "armwright-testset".
std::string get_manual_name(std::string title);

}  // namespace armwright
