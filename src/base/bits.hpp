// Compares numbers bit by bit: NaN equals itself, and -0 differs from +0.
#pragma once

#include <cstring>
#include <span>

namespace armwright {

inline bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace armwright
