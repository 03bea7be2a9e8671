// Reads the keys of an interface in web/src/data.ts, which defines the data of a page.
#pragma once

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/file.hpp"

namespace armwright {

inline std::set<std::string> read_contract(const std::string& interface) {
  const std::string text =
      read_file(std::filesystem::path(ARMWRIGHT_CONFIGS) / "../web/src/data.ts", 1 << 20);
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
