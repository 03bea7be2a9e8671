// What --version prints.
#pragma once

#include <string>

namespace armwright {

// Version, commit, compiler, machine with its SIMD levels, and the version of every library.
std::string describe_version();

}  // namespace armwright
