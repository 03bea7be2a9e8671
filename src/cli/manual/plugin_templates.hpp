// What `armwright new-plugin` writes: a small optimizer that works, to be replaced by the user's.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace armwright {

// "c++", "c", "python"
std::vector<std::string> plugin_languages();

struct PluginFile {
  std::string name;
  std::string content;
  bool is_program = false;
};

// The files of a plugin named `name` (a snake_case identifier) in one of plugin_languages().
std::vector<PluginFile> make_plugin_files(std::string_view language, std::string_view name);

}  // namespace armwright
