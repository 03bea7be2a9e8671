// Seeds for libraries whose random numbers begin at one of 2^32 places. Seeds below 2^32 are that
// place themselves; those above differ by either half.
#pragma once

#include <cstdint>

namespace armwright {

inline std::uint32_t fold_seed(std::uint64_t seed) {
  return static_cast<std::uint32_t>(seed ^ (seed >> 32));
}

}  // namespace armwright
