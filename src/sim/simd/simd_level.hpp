// Instruction sets that a batched engine can use, chosen at run time. Results differ between levels
// in the last bits, but not between machines, threads or batches at the same level.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

enum class SimdLevel : std::uint8_t { scalar, sse2, avx2, avx512 };  // in ascending order

const char* to_string(SimdLevel level);
std::vector<std::string> simd_names();            // all, in ascending order
SimdLevel parse_simd(std::string_view name);      // Error{usage} if there is none of that name
bool is_supported(SimdLevel level);               // by the CPU this runs on; scalar always is
std::vector<std::string> supported_simd_names();  // those, in ascending order
SimdLevel find_best_simd();  // the highest supported, and not above $ARMWRIGHT_SIMD if that is set

}  // namespace armwright
