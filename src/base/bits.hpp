// Compares numbers bit by bit: NaN equals itself, and -0 differs from +0.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace armwright {

inline bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint64_t, double>,
                            std::bit_cast<std::uint64_t, double>);
}

}  // namespace armwright
