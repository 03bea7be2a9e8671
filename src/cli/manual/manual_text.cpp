// Manual pages for a terminal.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "cli/manual/manual_formats.hpp"
#include "cli/terminal/table.hpp"

namespace armwright {
namespace {

constexpr int kTextIndent = 7;  // the distances that man uses, in columns
constexpr int kItemIndent = 14;
constexpr int kNestedIndent = 21;

std::string to_upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return text;
}

std::string indent(const std::string& text, int columns) {
  return std::string(static_cast<std::size_t>(columns), ' ') + text + "\n";
}

class TextWriter {
 public:
  TextWriter(const Style& style, int width) : style_(style), width_(width) {}

  void operator()(const Paragraph& paragraph) {
    add_wrapped(paragraph.text, kTextIndent);
    text += "\n";
  }
  void operator()(const Synopsis& synopsis) {
    text += indent(format(synopsis.line), kTextIndent) + "\n";
  }
  void operator()(const ManualItem& item) { add_item(item, kTextIndent, kItemIndent); }
  void operator()(const Verbatim& verbatim) {
    for (const std::string& line : verbatim.lines) {
      text += indent(line, kTextIndent);
    }
    text += "\n";
  }
  void operator()(const PageReferences& references) {
    std::vector<std::string> pages;
    std::ranges::transform(references.titles, std::back_inserter(pages),
                           [](const std::string& title) { return get_manual_name(title) + "(1)"; });
    add_wrapped(join(pages, ", "), kTextIndent);
    text += "\n";
  }

  std::string text;

 private:
  void add_wrapped(const std::string& words, int columns) {
    for (const std::string& line : wrap_words(words, width_ - columns)) {
      text += indent(line, columns);
    }
  }
  void add_item(const ManualItem& item, int name_column, int text_column) {
    std::string names, plain;
    for (const SpanLine& line : item.names) {
      const char* comma = names.empty() ? "" : ", ";
      names += comma + format(line);
      plain += comma + format(line, Style(false));
    }
    // The text stands beside a short name, and below a long one.
    const int gap = text_column - name_column - static_cast<int>(plain.size());
    const auto begin = text.size() + static_cast<std::size_t>(name_column);
    if (gap > 0 && !item.text.empty()) {
      add_wrapped(item.text, text_column);
      text.replace(begin, plain.size(), names);
    } else {
      text += indent(names, name_column);
      if (!item.text.empty()) {
        add_wrapped(item.text, text_column);
      }
    }
    text += "\n";
    for (const ManualItem& below : item.items) {
      add_item(below, text_column, kNestedIndent);
    }
  }
  std::string format(const SpanLine& line) const { return format(line, style_); }
  static std::string format(const SpanLine& line, const Style& style) {
    std::string words;
    for (const Span& span : line) {
      words += span.emphasis == Emphasis::literal ? style.bold(span.text) : span.text;
    }
    return words;
  }

  Style style_;
  int width_;
};

}  // namespace

std::string to_text(const ManualPage& page, const Style& style, int width) {
  const std::string head = to_upper(page.name) + "(1)";
  TextWriter writer(style, width);
  writer.text = head + "\n\n" + style.bold("NAME") + "\n";
  writer(Paragraph{page.name + " - " + page.summary});
  for (const ManualSection& section : page.sections) {
    writer.text += style.bold(to_upper(section.title)) + "\n";
    for (const ManualBlock& block : section.blocks) {
      std::visit(writer, block);
    }
  }
  writer.text.pop_back();  // the last empty line
  return writer.text;
}

}  // namespace armwright
