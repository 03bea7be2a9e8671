// Where the shipped configuration lies, and how a user's name for one of its files becomes a path.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// The folder with robots/, problems/ and designs/: $ARMWRIGHT_CONFIGS if set, else
// ../share/armwright/configs seen from the running program (the build tree and an installation look
// alike). Where this code is part of a shared object, as in Python's module, the running program is
// somebody else's: then share/armwright/configs in the nearest folder above that object that has
// it. Error{usage} says where it was looked for.
std::filesystem::path find_config_folder();

// What a user typed for a file of `kind` ("problems", "designs", "robots", "studies"): a path if it
// has a slash or the kind's extension, otherwise the name of a shipped file. A relative path is
// looked for in `beside` first (the folder of the file that names it), then in the current folder,
// and without a slash among the shipped files. Error{usage} with the valid names and the nearest.
std::filesystem::path resolve_config(std::string_view kind, std::string_view name_or_path,
                                     const std::filesystem::path& beside = {});

// Names of the shipped files of a kind, sorted; those that begin with an underscore are only there
// to be extended.
std::vector<std::string> list_configs(std::string_view kind);

}  // namespace armwright
