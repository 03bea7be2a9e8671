#include "cli/manual/notes.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::string_view kExamples = "Examples:";
constexpr std::string_view kExitCodes = "Exit codes:";
constexpr std::string_view kEnvironment = "Environment: ";

std::vector<std::vector<std::string>> split_paragraphs(const std::string& notes) {
  std::vector<std::vector<std::string>> paragraphs(1);
  for (const std::string& line : split(notes, '\n')) {
    if (line.empty()) {
      paragraphs.emplace_back();
    } else {
      paragraphs.back().push_back(line);
    }
  }
  std::erase_if(paragraphs, [](const auto& lines) { return lines.empty(); });
  return paragraphs;
}

std::vector<ManualBlock> make_list(std::span<const std::string> lines) {
  std::vector<ManualBlock> blocks;
  for (const std::string& line : lines) {
    const ListEntry entry = read_list_entry(line).value();
    blocks.emplace_back(ManualItem{{{{Emphasis::literal, entry.name}}}, entry.text, {}});
  }
  return blocks;
}

bool is_list(std::span<const std::string> lines) {
  return std::ranges::all_of(
      lines, [](const std::string& line) { return read_list_entry(line).has_value(); });
}

Verbatim make_verbatim(std::span<const std::string> lines) {
  constexpr std::string_view kIndent = "  ";
  Verbatim verbatim;
  for (const std::string& line : lines) {
    verbatim.lines.push_back(line.starts_with(kIndent) ? line.substr(kIndent.size()) : line);
  }
  return verbatim;
}

}  // namespace

std::optional<ListEntry> read_list_entry(const std::string& line) {
  const auto begin = line.find_first_not_of(' ');
  const auto end = line.find(' ', begin);
  const auto text = line.find_first_not_of(' ', end);
  if (begin == line.npos || end == line.npos || text == line.npos || text - end < 2) {
    return std::nullopt;
  }
  return ListEntry{line.substr(begin, end - begin), line.substr(text)};
}

CommandNotes read_notes(const std::string& notes) {
  CommandNotes read;
  for (const std::vector<std::string>& lines : split_paragraphs(notes)) {
    const auto below = std::span(lines).subspan(1);
    if (lines.front() == kExamples) {
      read.sections.push_back({"Examples", {make_verbatim(below)}});
    } else if (lines.front() == kExitCodes && is_list(below)) {
      read.sections.push_back({"Exit status", make_list(below)});
    } else if (lines.front().starts_with(kEnvironment)) {
      read.sections.push_back(
          {"Environment", {Paragraph{join(lines, " ").substr(kEnvironment.size())}}});
    } else if (is_list(lines)) {
      std::ranges::move(make_list(lines), std::back_inserter(read.text));
    } else {
      read.text.emplace_back(Paragraph{join(lines, " ")});
    }
  }
  return read;
}

}  // namespace armwright
