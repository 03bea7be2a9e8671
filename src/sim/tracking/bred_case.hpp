// Test cases that can be bred: of a set named "coevolved/ID" the number of a case is its genome,
// four keys of 15 bits, the first one lowest. Each key gives a quarter of the points their
// directions, so that a child that takes keys of two parents moves as the one does in some quarters
// and as the other in the rest; only where it starts a quarter from elsewhere, and a direction
// would lead out of the sphere, is another one drawn. A case stays a pure function of set and
// number.
#pragma once

#include <cstdint>
#include <string_view>

namespace armwright {

inline constexpr std::string_view kBredPrefix = "coevolved/";
inline constexpr int kGenomeKeys = 4;
inline constexpr int kGenomeKeyBits = 15;
inline constexpr std::uint64_t kGenomeKeyValues = std::uint64_t{1} << kGenomeKeyBits;

constexpr std::uint64_t get_key(std::uint64_t genome, int place) {
  return genome >> (kGenomeKeyBits * place) & (kGenomeKeyValues - 1);
}

constexpr std::uint64_t set_key(std::uint64_t genome, int place, std::uint64_t key) {
  const int shift = kGenomeKeyBits * place;
  return (genome & ~((kGenomeKeyValues - 1) << shift)) | key << shift;
}

// Which key the point k = 1..n of a case follows.
constexpr int find_key_place(int k, int points) {
  return (k - 1) * kGenomeKeys / points;
}

}  // namespace armwright
