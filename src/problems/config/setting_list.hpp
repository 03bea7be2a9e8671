// Every key of a problem's and of a design's file, with unit, default, what is allowed and what it
// means. What is allowed and the defaults are what the readers themselves ask for while they read
// specimens (ConfigTable::asked); the meanings stand in a table, setting_words.cpp, and a key
// without one is a failed test.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/config.hpp"

namespace armwright {

struct Setting {
  std::string path;  // "task.speed_m_per_s"; of the tables of an array "requirement[].use"
  std::string unit;  // by the key's last letters: "m/s"; empty if it has none
  std::vector<std::string> allowed;    // more than one where it depends on other keys
  std::vector<std::string> fallbacks;  // likewise; none: it is required, or its absence has a
                                       // meaning of its own
  std::string meaning;                 // empty: nobody has written it down
};

struct SettingWords {
  std::string path;
  std::string meaning;
};

std::vector<Setting> list_problem_settings();
std::vector<Setting> list_design_settings();

// Of documents that were read, by path. Tables themselves are left out; so are words of keys that
// nobody asked for.
std::vector<Setting> make_settings(std::span<const std::vector<AskedKey>> documents,
                                   std::span<const SettingWords> words);

// "task.speed_m_per_s" -> "m/s"; empty for a key without a unit.
std::string get_key_unit(std::string_view path);

}  // namespace armwright
