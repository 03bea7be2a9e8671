#include "base/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace armwright {

// Brackets within strings do not count. Exact as far as the text is valid; what is behind the first
// syntax error the parser never gets to.
void check_json_depth(std::string_view text, const std::string& name) {
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    switch (text[at]) {
      case '[':
      case '{':
        if (++depth > kJsonDepthLimit) {
          const auto line =
              1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
          throw Error(ErrorKind::bad_data,
                      fmt::format("{}:{}: arrays and objects nest deeper than {} levels",
                                  sanitize(name), line, kJsonDepthLimit));
        }
        break;
      case ']':
      case '}':
        depth -= depth > 0 ? 1 : 0;
        break;
      case '"':
        for (++at; at < text.size() && text[at] != '"'; ++at) {
          at += text[at] == '\\' ? 1 : 0;
        }
        break;
      default:
        break;
    }
  }
}

std::string read_json_file(const std::filesystem::path& file, std::size_t limit_bytes) {
  std::string text = read_file(file, limit_bytes);
  check_json_depth(text, file.string());
  return text;
}

}  // namespace armwright
