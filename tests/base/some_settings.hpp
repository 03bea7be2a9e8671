// Short declarations of settings and tables, for tests of ConfigTable.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/setting.hpp"

namespace armwright {

inline Setting<std::string> text(const char* key, std::optional<std::string> fallback = {}) {
  return {key, std::move(fallback), ""};
}

inline Setting<std::string> choice(const char* key, const std::vector<std::string>& valid,
                                   std::optional<std::string> fallback = {}) {
  return {key, one_of(valid), std::move(fallback), ""};
}

inline Setting<double> number(const char* key, Range range = {},
                              std::optional<double> fallback = {}) {
  return {key, range, fallback, ""};
}

inline Setting<std::int64_t> integer(const char* key, Range range = {},
                                     std::optional<std::int64_t> fallback = {}) {
  return {key, range, fallback, ""};
}

inline Setting<bool> boolean(const char* key, std::optional<bool> fallback = {}) {
  return {key, fallback, ""};
}

inline Setting<std::vector<double>> numbers(const char* key, Range range = {}) {
  return {key, range, kNoDefault, ""};
}

inline Setting<std::vector<std::string>> texts(const char* key) {
  return {key, kNoDefault, ""};
}

inline SettingTable table(const char* key) {
  return {.key = key};
}

inline SettingTable array(const char* key) {
  return {.key = key, .is_array = true};
}

}  // namespace armwright
