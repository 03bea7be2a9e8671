// What holds for the descriptions of all plugins, shared libraries and programs.
#pragma once

namespace armwright {

// Of integer options, their ranges included: doubles up to 2^53 tell integers apart.
inline constexpr double kLargestInteger = 9007199254740992;

}  // namespace armwright
