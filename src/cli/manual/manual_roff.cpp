// Manual pages for man: roff with the macros of man(7).

#include <fmt/format.h>

#include <algorithm>

#include "cli/manual/manual_formats.hpp"

namespace armwright {
namespace {

// Escapes text so that man shows it unchanged and it can be copied. Without this, a '-' would
// become a hyphen, and quotes would become typographic quotes.
std::string escape_roff(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '\\':
        escaped += "\\e";
        break;
      case '-':
        escaped += "\\-";
        break;
      case '\'':
        escaped += "\\(aq";
        break;
      case '`':
        escaped += "\\(ga";
        break;
      case '^':
        escaped += "\\(ha";
        break;
      case '~':
        escaped += "\\(ti";
        break;
      case '"':
        escaped += "\\(dq";  // a quote would end an argument of a macro
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

// Protects a line that begins with a '.', which roff would read as a command.
std::string make_line(const std::string& escaped) {
  return (escaped.starts_with('.') ? "\\&" : "") + escaped + "\n";
}

std::string format_spans(const SpanLine& line) {
  std::string text;
  for (const Span& span : line) {
    const std::string escaped = escape_roff(span.text);
    text += span.emphasis == Emphasis::literal       ? "\\fB" + escaped + "\\fR"
            : span.emphasis == Emphasis::placeholder ? "\\fI" + escaped + "\\fR"
                                                     : escaped;
  }
  return text;
}

class RoffWriter {
 public:
  // A macro separates paragraphs. There is none after a title, as man would warn.
  void begin_section(const std::string& title) {
    std::string upper = escape_roff(title);
    std::ranges::transform(upper, upper.begin(), [](char c) {
      return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    text += ".SH " + (upper.find(' ') == upper.npos ? upper : '"' + upper + '"') + "\n";
    is_first_ = true;
  }

  void operator()(const Paragraph& paragraph) {
    separate();
    text += make_line(escape_roff(paragraph.text));
  }
  void operator()(const Synopsis& synopsis) {
    separate();
    text += make_line(format_spans(synopsis.line));
  }
  void operator()(const ManualItem& item) {
    add_item(item);
    is_first_ = false;
  }
  void operator()(const Verbatim& verbatim) {
    separate();
    text += ".EX\n";
    for (const std::string& line : verbatim.lines) {
      text += make_line(escape_roff(line));
    }
    text += ".EE\n";
  }
  void operator()(const PageReferences& references) {
    separate();
    for (const std::string& title : references.titles) {
      text += fmt::format(".BR {} (1){}\n", escape_roff(get_manual_name(title)),
                          &title == &references.titles.back() ? "" : ",");
    }
  }

  std::string text;

 private:
  void separate() {
    text += is_first_ ? "" : ".PP\n";
    is_first_ = false;
  }
  void add_item(const ManualItem& item) {
    text += ".TP\n";
    std::string names;
    for (const SpanLine& line : item.names) {
      names += (names.empty() ? "" : ", ") + format_spans(line);
    }
    text += make_line(names);
    text += make_line(item.text.empty() ? "\\&" : escape_roff(item.text));
    if (!item.items.empty()) {
      text += ".RS\n";
      for (const ManualItem& below : item.items) {
        add_item(below);
      }
      text += ".RE\n";
    }
  }

  bool is_first_ = true;
};

}  // namespace

std::string to_roff(const ManualPage& page, const std::string& version, const std::string& date) {
  RoffWriter writer;
  std::string head = escape_roff(page.name);
  std::ranges::transform(head, head.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  writer.text = fmt::format(
      ".\\\" Written by 'armwright manual --format man': change what the program's --help says.\n"
      ".TH {} 1 {} \"armwright {}\" \"User Commands\"\n"
      ".nh\n.nr HY 0\n.ad l\n"  // no hyphenation, as half a flag cannot be copied
      ".SH NAME\n{} \\- {}\n",
      head, escape_roff(date), escape_roff(version), escape_roff(page.name),
      escape_roff(page.summary));
  for (const ManualSection& section : page.sections) {
    writer.begin_section(section.title);
    for (const ManualBlock& block : section.blocks) {
      std::visit(writer, block);
    }
  }
  return writer.text;
}

}  // namespace armwright
