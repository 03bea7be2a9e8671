// Manual pages as Markdown, for the reference of all commands.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "cli/manual/manual_formats.hpp"
#include "cli/terminal/markdown.hpp"

namespace armwright {
namespace {

std::string join_spans(const SpanLine& line) {
  std::string text;
  for (const Span& span : line) {
    text += span.text;
  }
  return text;
}

class MarkdownWriter {
 public:
  void operator()(const Paragraph& paragraph) {
    end_list();
    text += escape_markdown(paragraph.text) + "\n\n";
  }
  void operator()(const Synopsis& synopsis) {
    end_list();
    text += "    " + join_spans(synopsis.line) + "\n\n";
  }
  void operator()(const ManualItem& item) {
    add_item(item, "");
    is_in_list_ = true;
  }
  void operator()(const Verbatim& verbatim) {
    end_list();
    for (const std::string& line : verbatim.lines) {
      text += "    " + line + "\n";
    }
    text += "\n";
  }
  void operator()(const PageReferences& references) {
    end_list();
    std::vector<std::string> links;
    std::ranges::transform(references.titles, std::back_inserter(links),
                           [](const std::string& title) {
                             // Markdown makes the same anchor of a section's title.
                             return fmt::format("[{}](#{})", title, get_manual_name(title));
                           });
    text += join(links, ", ") + "\n\n";
  }
  void end_list() {
    text += is_in_list_ ? "\n" : "";
    is_in_list_ = false;
  }

  std::string text;

 private:
  void add_item(const ManualItem& item, const std::string& indent) {
    std::vector<std::string> names;
    std::ranges::transform(item.names, std::back_inserter(names),
                           [](const SpanLine& line) { return "`" + join_spans(line) + "`"; });
    text += fmt::format("{}- {}{}{}\n", indent, join(names, ", "), item.text.empty() ? "" : ": ",
                        escape_markdown(item.text));
    for (const ManualItem& below : item.items) {
      add_item(below, indent + "  ");
    }
  }

  bool is_in_list_ = false;
};

}  // namespace

std::string to_markdown(const ManualPage& page) {
  MarkdownWriter writer;
  writer.text = fmt::format("## {}\n\n", page.title);
  for (const ManualSection& section : page.sections) {
    // Synopsis and description need no title. The other titles are bold text and no headings, as
    // every command has them.
    if (section.title != "Synopsis" && section.title != "Description") {
      writer.end_list();
      writer.text += fmt::format("**{}**\n\n", section.title);
    }
    for (const ManualBlock& block : section.blocks) {
      std::visit(writer, block);
    }
  }
  writer.end_list();
  return writer.text;
}

std::string to_markdown_reference(std::span<const ManualPage> pages) {
  std::string text =
      "<!-- Written by scripts/docs from the program's own commands: change their --help, not this "
      "file. -->\n# Commands\n\n"
      "All commands of the program with all arguments and flags, as `armwright manual COMMAND` "
      "shows them, and `man armwright-COMMAND` if the packages are installed. `armwright COMMAND "
      "--help` is shorter.\n\n| command | what it does |\n|---|---|\n";
  for (const ManualPage& page : pages) {
    text +=
        fmt::format("| [{}](#{}) | {} |\n", page.title, page.name, escape_markdown(page.summary));
  }
  text += "\n";
  for (const ManualPage& page : pages) {
    text += to_markdown(page);
  }
  text.pop_back();
  return text;
}

}  // namespace armwright
