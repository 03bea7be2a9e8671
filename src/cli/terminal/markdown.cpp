#include "cli/terminal/markdown.hpp"

#include <cctype>

#include "base/text.hpp"

namespace armwright {

std::string escape_markdown(std::string_view text) {
  constexpr std::string_view kSpecial = "\\`*[]<>|~&$";
  const std::string clean = sanitize(text);
  const auto is_word = [&](std::size_t i) {
    return i < clean.size() && std::isalnum(static_cast<unsigned char>(clean[i])) != 0;
  };
  std::string escaped;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    // Markdown does not interpret an underscore within a word.
    const bool is_bare_underscore = clean[i] == '_' && !(i > 0 && is_word(i - 1) && is_word(i + 1));
    if (kSpecial.find(clean[i]) != kSpecial.npos || is_bare_underscore) {
      escaped += '\\';
    }
    escaped += clean[i];
  }
  return escaped;
}

// In a table, a bar ends the cell even between backticks.
std::string format_code(const std::string& text) {
  if (text.empty()) {
    return "(empty)";
  }
  if (text.find('`') != text.npos) {
    return escape_markdown(text);
  }
  std::string code;
  for (const char c : sanitize(text)) {
    code += c == '|' ? "\\|" : std::string(1, c);
  }
  return "`" + code + "`";
}

}  // namespace armwright
