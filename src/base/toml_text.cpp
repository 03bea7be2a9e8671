#include "base/toml_text.hpp"

#include <nlohmann/json.hpp>

namespace armwright {

std::string quote_toml(std::string_view text) {
  // A JSON string is a valid TOML string, except for one character that TOML requires to be
  // escaped.
  std::string quoted =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = quoted.find('\x7f'); at != std::string::npos;
       at = quoted.find('\x7f', at)) {
    quoted.replace(at, 1, "\\u007f");
  }
  return quoted;
}

}  // namespace armwright
