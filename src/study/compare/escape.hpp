// Names of people's choosing as names of files.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// Letters, digits, '_', '-' and, but for the first place, '.' as they are, any other byte as %XX:
// no two names come out alike, none is hidden or leads out of its folder.
std::string escape_name(std::string_view name);

}  // namespace armwright
