// A manual page of one command: what it says, apart from how it is set. manual_formats.hpp sets it.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "cli/manual/command_definition.hpp"

namespace armwright {

enum class Emphasis { none, literal, placeholder };  // as it is typed; what something stands for

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
// What is explained, by all its names, and the explanation; within that perhaps a list.
struct ManualItem {
  std::vector<SpanLine> names;
  std::string text;
  std::vector<ManualItem> items;
};
struct Verbatim {
  std::vector<std::string> lines;
};
// Other pages, all of chapter 1.
struct PageReference {
  std::string name;   // as ManualPage's
  std::string title;  // as ManualPage's
};
struct PageReferences {
  std::vector<PageReference> pages;
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
  std::vector<ManualSection> sections;  // those behind the name and the summary
};

// `program`: where the other pages come from.
ManualPage make_manual_page(const CommandDefinition& command, const CommandDefinition& program);

// "armwright-testset-export"
std::string get_manual_name(const CommandDefinition& command);

}  // namespace armwright
