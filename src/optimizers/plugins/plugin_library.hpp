// Optimizers in shared libraries (include/armwright/plugin.h). The library is opened in a child
// process only: this process learns its description as bytes, and every run calls it in a child of
// its own, unless the user wants it here (isolate=false).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "optimizers/interface/isolation.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// A row named `name` (default: the path as given), whose options are the plugin's, isolate and
// make_watch_options(). Error{bad_data}, with the reason and what to do, if the file is no plugin
// that can be used.
OptimizerRow load_library_plugin(const std::filesystem::path& file, const std::string& name = "",
                                 const ProcessLimits& loading = {.silence_s = 20});

// Whether a name of an optimizer means a file: it has a slash or ends in ".so".
bool is_library_name(std::string_view name);

// NAME.so or libNAME.so in the folders of the environment's ARMWRIGHT_PLUGINS (separated by colons)
// and in ../lib/armwright/plugins beside the program, whichever comes first.
std::optional<std::filesystem::path> find_library_plugin(std::string_view name);

}  // namespace armwright
