// The files that `armwright new-plugin` writes: a small optimizer that works and that the user
// replaces by an own method.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// Returns "c++", "c" and "python".
std::vector<std::string> plugin_languages();

struct PluginFile {
  std::string name;
  std::string content;
  bool is_program = false;  // whether it gets the permission to be executed
};

// Returns the files of a plugin named `name` (a snake_case identifier) in one of
// plugin_languages(). The list is empty for any other language.
std::vector<PluginFile> make_plugin_files(std::string_view language, std::string_view name);

}  // namespace armwright
