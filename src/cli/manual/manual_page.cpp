#include "cli/manual/manual_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/text.hpp"

namespace armwright {
namespace {

// An entry of a list: a name, at least two blanks, and a text: "holds   not more cases fail".
struct ListEntry {
  std::string name;
  std::string text;
};

// The text that --help prints below the flags.
struct CommandNotes {
  std::vector<ManualBlock> text;        // the paragraphs without a title
  std::vector<ManualSection> sections;  // "Examples", "Exit status", "Environment"
};

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

std::optional<ListEntry> read_list_entry(const std::string& line) {
  const auto begin = line.find_first_not_of(' ');
  const auto end = line.find(' ', begin);
  const auto text = line.find_first_not_of(' ', end);
  if (begin == line.npos || end == line.npos || text == line.npos || text - end < 2) {
    return std::nullopt;
  }
  return ListEntry{line.substr(begin, end - begin), line.substr(text)};
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

Span literal(const std::string& text) {
  return {Emphasis::literal, text};
}
Span placeholder(const std::string& text) {
  return {Emphasis::placeholder, text};
}

std::string end_sentence(const std::string& text) {
  return text.empty() || text.ends_with('.') || text.ends_with('?') ? text : text + ".";
}

Synopsis make_synopsis(const CommandDefinition& command) {
  SpanLine line = {literal(command.get_title()),
                   {Emphasis::none, " ["},
                   placeholder("OPTIONS"),
                   {Emphasis::none, "]"}};
  const auto add = [&line](const std::string& name, bool is_required, bool repeats) {
    line.push_back({Emphasis::none, is_required ? " " : " ["});
    line.push_back(placeholder(name));
    line.push_back({Emphasis::none, std::string(repeats && !name.ends_with("...") ? " ..." : "") +
                                        (is_required ? "" : "]")});
  };
  // The synopsis shows required flags.
  for (const ArgumentDefinition& flag : command.flags) {
    if (flag.is_required) {
      line.push_back(literal(" " + flag.get_key()));
      line.push_back(placeholder(" " + flag.value));
    }
  }
  for (const ArgumentDefinition& argument : command.arguments) {
    add(argument.name, argument.is_required, argument.repeats);
  }
  if (!command.commands.empty()) {
    add("COMMAND", true, false);
  }
  return {line};
}

// Makes an item of a flag, an argument or a command. Lines "NAME   text" of the description become
// a list, and all other lines one paragraph.
ManualItem make_item(std::vector<SpanLine> names, const std::string& description) {
  ManualItem item = {std::move(names), "", {}};
  for (const std::string& line : split(description, '\n')) {
    if (const auto entry = read_list_entry(line)) {
      item.items.push_back({{{literal(entry->name)}}, end_sentence(entry->text), {}});
    } else {
      item.text += (item.text.empty() ? "" : " ") + line;
    }
  }
  if (item.items.empty()) {
    item.text = end_sentence(item.text);
  }
  return item;
}

ManualItem make_argument_item(const ArgumentDefinition& argument) {
  std::vector<SpanLine> names;
  if (!argument.name.empty()) {
    names.push_back({placeholder(argument.name)});
  }
  for (const std::string& flag : argument.short_names) {
    names.push_back({literal(flag)});
  }
  for (const std::string& flag : argument.long_names) {
    names.push_back({literal(flag)});
  }
  if (!argument.value.empty()) {
    SpanLine& last = names.back();
    last.push_back({Emphasis::none, argument.is_value_optional ? " [" : " "});
    last.push_back(placeholder(argument.value));
    if (argument.is_value_optional) {
      last.push_back({Emphasis::none, "]"});
    }
  }
  ManualItem item = make_item(std::move(names), argument.description);
  if (argument.is_required && argument.name.empty()) {
    item.text = "Required. " + item.text;
  }
  if (!argument.excludes.empty()) {
    item.text += fmt::format(" Not together with {}.", join(argument.excludes, ", "));
  }
  if (!argument.environment.empty()) {
    item.text += fmt::format(" The environment variable {} is used if it is not given.",
                             argument.environment);
  }
  return item;
}

std::vector<ManualSection> make_argument_sections(const CommandDefinition& command) {
  std::vector<ManualSection> sections;
  const auto add = [&sections](const std::string& title, ManualItem item) {
    auto section = std::ranges::find(sections, title, &ManualSection::title);
    if (section == sections.end()) {
      section = sections.insert(section, ManualSection{title, {}});
    }
    section->blocks.push_back(std::move(item));
  };
  for (const CommandDefinition& below : command.commands) {
    add("Commands", make_item({{literal(below.words.back())}}, below.summary));
  }
  for (const ArgumentDefinition& argument : command.arguments) {
    add("Arguments", make_argument_item(argument));
  }
  for (const ArgumentDefinition& flag : command.flags) {
    add(flag.group == "Options" ? "Options" : flag.group + " options", make_argument_item(flag));
  }
  return sections;
}

// Returns whether the notes contain the other command, as 'armwright NAME'.
bool mentions(const CommandDefinition& command, const CommandDefinition& other) {
  constexpr std::string_view kEnds = " '\n.,";
  const std::string& notes = command.notes;
  const std::string title = other.get_title();
  for (auto at = notes.find(title); at != notes.npos; at = notes.find(title, at + 1)) {
    const auto end = at + title.size();
    if (end == notes.size() || kEnds.find(notes[end]) != kEnds.npos) {
      return true;
    }
  }
  return false;
}

bool is_below(const CommandDefinition& above, const CommandDefinition& command) {
  return command.words.size() == above.words.size() + 1 &&
         std::ranges::equal(above.words, std::span(command.words).first(above.words.size()));
}

// Returns references to the commands below and above it, the program, and the commands in the
// notes.
PageReferences make_references(const CommandDefinition& command, const CommandDefinition& program) {
  PageReferences references;
  for (const CommandDefinition* other : list_all_commands(program)) {
    if (other != &command && (is_below(command, *other) || is_below(*other, command) ||
                              other == &program || mentions(command, *other))) {
      references.titles.push_back(other->get_title());
    }
  }
  return references;
}

ManualSection make_files_section() {
  return {"Files",
          {ManualItem{{{literal("results/")}},
                      "Runs and studies, in the current folder, unless --out names another "
                      "folder.",
                      {}},
           ManualItem{{{literal("PREFIX/share/armwright/configs/")}},
                      "The shipped problems, designs, robots, perturbations and studies.",
                      {}},
           ManualItem{{{literal("PREFIX/lib/armwright/plugins/")}},
                      "Plugins, which can be named without a path.",
                      {}},
           Paragraph{"PREFIX is the folder above that of the program itself, for example /usr."}}};
}

}  // namespace

std::string get_manual_name(std::string title) {
  std::ranges::replace(title, ' ', '-');
  return title;
}

ManualPage make_manual_page(const CommandDefinition& command, const CommandDefinition& program) {
  ManualPage page = {
      get_manual_name(command.get_title()), command.get_title(), command.summary, {}};
  if (page.summary.ends_with('.') && !page.summary.ends_with("...")) {
    page.summary.pop_back();
  }
  page.sections.push_back({"Synopsis", {make_synopsis(command)}});
  CommandNotes notes = read_notes(command.notes);
  ManualSection description = {"Description", {Paragraph{end_sentence(command.summary)}}};
  std::ranges::move(notes.text, std::back_inserter(description.blocks));
  page.sections.push_back(std::move(description));
  std::ranges::move(make_argument_sections(command), std::back_inserter(page.sections));
  for (const char* title : {"Exit status", "Environment"}) {
    const auto section = std::ranges::find(notes.sections, title, &ManualSection::title);
    if (section != notes.sections.end()) {
      page.sections.push_back(std::move(*section));
    } else if (&command != &program && title == std::string("Exit status")) {
      page.sections.push_back(
          {title,
           {Paragraph{"0 if the command succeeds; armwright(1) lists the other codes, which are "
                      "the same for all commands."}}});
    }
  }
  if (&command == &program) {
    page.sections.push_back(make_files_section());
  }
  const auto examples = std::ranges::find(notes.sections, "Examples", &ManualSection::title);
  if (examples != notes.sections.end()) {
    page.sections.push_back(std::move(*examples));
  }
  page.sections.push_back({"See also", {make_references(command, program)}});
  return page;
}

}  // namespace armwright
