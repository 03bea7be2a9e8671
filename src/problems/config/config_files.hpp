// Finds the shipped configuration, and the path of a file that a user names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// Returns the folder with robots/, problems/ and designs/. It is $ARMWRIGHT_CONFIGS if that is set,
// else ../share/armwright/configs as seen from the running program; the build tree and an
// installation have the same layout. If this code is part of a shared object (Python's module), it
// is share/armwright/configs in the nearest folder above that object that has it. Throws
// Error{usage} that names the folder that was expected.
std::filesystem::path find_config_folder();

// Returns the path of a file of `kind` ("problems", "designs", "gains", "robots", "plants",
// "studies", "perturbations", "reproductions") that a user names. A text with a slash or with the kind's
// extension is a path, any other text the name of a shipped file. A relative path is looked for in
// `beside` first (the folder of the file that names it), then in the current folder, and without a
// slash among the shipped files. Throws Error{usage} with the valid names and the nearest one.
std::filesystem::path resolve_config(std::string_view kind, std::string_view name_or_path,
                                     const std::filesystem::path& beside = {});

// Returns the names of the shipped files of a kind, sorted. It leaves out names that begin with an
// underscore: these files are there only to be extended.
std::vector<std::string> list_configs(std::string_view kind);

}  // namespace armwright
