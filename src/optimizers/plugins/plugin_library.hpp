// Optimizers in shared libraries (include/armwright/plugin.h). Only a child process opens the
// library. This process gets the description as bytes, and each run calls the library in a child
// process of its own, unless the user sets isolate=false.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "optimizers/interface/isolation.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns a row named `name` (default: the path). Its options are those of the plugin, isolate, and
// make_isolation_options(). Throws Error{bad_data}, with the reason and the remedy, if the file is
// no usable plugin.
OptimizerRow load_library_plugin(const std::filesystem::path& file, const std::string& name = "",
                                 const ProcessLimits& loading = {.silence_s = 20});

// Returns whether an optimizer's name means a file: it has a slash or ends in ".so".
bool is_library_name(std::string_view name);

// Searches NAME.so and libNAME.so in the folders of the environment variable ARMWRIGHT_PLUGINS
// (separated by colons), then in ../lib/armwright/plugins beside the program. Returns the first one
// found.
std::optional<std::filesystem::path> find_library_plugin(std::string_view name);

}  // namespace armwright
