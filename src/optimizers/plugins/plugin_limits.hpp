// What holds for the descriptions of all plugins, shared libraries and programs.
#pragma once

#include <cstddef>

namespace armwright {

// Of integer options, their ranges included: doubles up to 2^53 tell integers apart.
inline constexpr double kLargestInteger = 9007199254740992;
// More than anybody could read.
inline constexpr std::size_t kMaxOptions = 1000;
inline constexpr std::size_t kMaxChoices = 1000;  // of an option

}  // namespace armwright
