// The instruction sets that a batched engine can use; the level is chosen at run time. Results of
// different levels differ in the last bits. At the same level they are identical on all machines
// and for any number of threads and any batch size.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

enum class SimdLevel : std::uint8_t { scalar, sse2, avx2, avx512 };  // in ascending order

const char* to_string(SimdLevel level);
// Returns the names of all levels, in ascending order.
std::vector<std::string> simd_names();
// Throws Error{usage} if no level has that name.
SimdLevel parse_simd(std::string_view name);
// Returns whether this CPU supports the level. Every CPU supports `scalar`.
bool is_supported(SimdLevel level);
// Returns the names of the levels that this CPU supports, in ascending order.
std::vector<std::string> supported_simd_names();
// Returns the highest level that this CPU supports. The environment variable ARMWRIGHT_SIMD, if
// set, limits it.
SimdLevel find_best_simd();

}  // namespace armwright
