#include "report/formats/export_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"

namespace armwright {
namespace {

// Returns the character at `at` in a UTF-8 text and moves `at` behind it.
char32_t take_character(std::string_view text, std::size_t& at) {
  const auto first = static_cast<unsigned char>(text[at++]);
  const int more = first < 0x80 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
  char32_t code = more == 0 ? first : first & (0x3f >> more);
  for (int i = 0; i < more; ++i) {
    code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3f);
  }
  return code;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string escape_yaml(std::string_view text) {
  const std::string printable = sanitize(text);  // whole UTF-8
  std::string quoted;
  for (std::size_t at = 0; at < printable.size();) {
    const char32_t code = take_character(printable, at);
    if (code == '"' || code == '\\') {
      quoted += '\\';
      quoted += static_cast<char>(code);
    } else if (code >= 0x20 && code < 0x7f) {
      quoted += static_cast<char>(code);
    } else {
      const auto number = static_cast<unsigned>(code);
      quoted += code <= 0xff     ? fmt::format("\\x{:02x}", number)
                : code <= 0xffff ? fmt::format("\\u{:04x}", number)
                                 : fmt::format("\\U{:08x}", number);
    }
  }
  return quoted;
}

std::string quote_yaml(std::string_view text) {
  return '"' + escape_yaml(text) + '"';
}

std::string format_yaml(double value) {
  std::string text = format_exact(value);
  if (text.find('.') == std::string::npos) {
    text.insert(std::min(text.find('e'), text.size()), ".0");
  }
  return text;
}

}  // namespace armwright
