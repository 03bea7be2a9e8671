// TOML in which one key has another value.
#pragma once

#include <string>
#include <vector>

#include "base/text.hpp"

namespace armwright {

inline constexpr const char* kDate = "1979-05-27";  // no setting is a date

// Returns the text with `key = value` in the table under `header` ("" for the top of the text), in
// place of the key's own line if it has one. The table must be there.
inline std::string change_text(const std::string& text, const std::string& header,
                               const std::string& key, const std::string& value) {
  std::vector<std::string> lines;
  std::string table;
  const std::string line_of_key = key + " = " + value;
  if (header.empty()) {
    lines.push_back(line_of_key);
  }
  for (const std::string& line : split(text, '\n')) {
    table = line.starts_with('[') ? line : table;
    if (table != header || !line.starts_with(key + " = ")) {
      lines.push_back(line);
    }
    if (line == header && !header.empty()) {
      lines.push_back(line_of_key);
    }
  }
  return join(lines, "\n");
}

// Returns the header of the table that a listed setting stands in: "task.speed_m_per_s" has
// "[task]", "requirement[].use" has "[[requirement]]", "title" has "".
inline std::string make_header(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  const std::string table = dot == std::string::npos ? "" : path.substr(0, dot);
  return table.empty()           ? ""
         : table.ends_with("[]") ? "[[" + table.substr(0, table.size() - 2) + "]]"
                                 : "[" + table + "]";
}

// Returns the path of the setting's value in the first table of an array: "requirement[0].use".
inline std::string make_first_path(std::string path) {
  const std::size_t brackets = path.find("[]");
  return brackets == std::string::npos ? path : path.replace(brackets, 2, "[0]");
}

}  // namespace armwright
