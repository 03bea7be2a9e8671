// Reads the keys of an interface in web/src/data.ts and web/src/data, which define the data of a page.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/file.hpp"

namespace armwright {

// Returns the text of all files with the types of the page's data.
inline std::string read_page_types() {
  const auto source = std::filesystem::path(ARMWRIGHT_CONFIGS) / "../web/src";
  std::string text = read_file(source / "data.ts", 1 << 20);
  for (const auto& entry : std::filesystem::directory_iterator(source / "data")) {
    text += read_file(entry.path(), 1 << 20);
  }
  return text;
}

inline std::set<std::string> read_contract(const std::string& interface) {
  const std::string text = read_page_types();
  const std::regex head("export interface " + interface + "( extends (\\w+))? \\{");
  std::smatch found;
  if (!std::regex_search(text, found, head)) {
    throw std::runtime_error("no interface " + interface);
  }
  std::set<std::string> keys;
  if (found[2].matched) {
    keys = read_contract(found[2]);
  }
  std::istringstream body(found.suffix());
  const std::regex key("^  (\\w+)\\??: .*");
  for (std::string line; std::getline(body, line) && line != "}";) {
    if (std::regex_match(line, found, key)) {
      keys.insert(found[1]);
    }
  }
  return keys;
}

inline std::set<std::string> list_keys(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) {
    keys.insert(key);
  }
  return keys;
}

}  // namespace armwright
