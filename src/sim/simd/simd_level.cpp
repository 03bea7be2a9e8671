#include "sim/simd/simd_level.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::array kLevels = {SimdLevel::scalar, SimdLevel::sse2, SimdLevel::avx2,
                                SimdLevel::avx512};

SimdLevel find_level(std::string_view what, std::string_view name) {
  const auto found =
      std::ranges::find_if(kLevels, [&](SimdLevel level) { return to_string(level) == name; });
  if (found == kLevels.end()) {
    throw Error(ErrorKind::usage, describe_unknown(what, name, simd_names()));
  }
  return *found;
}

}  // namespace

const char* to_string(SimdLevel level) {
  switch (level) {
    case SimdLevel::scalar:
      return "scalar";
    case SimdLevel::sse2:
      return "sse2";
    case SimdLevel::avx2:
      return "avx2";
    case SimdLevel::avx512:
      return "avx512";
  }
  return "?";
}

std::vector<std::string> simd_names() {
  std::vector<std::string> names;
  for (const SimdLevel level : kLevels) {
    names.emplace_back(to_string(level));
  }
  return names;
}

SimdLevel parse_simd(std::string_view name) {
  return find_level("SIMD level", name);
}

bool is_supported(SimdLevel level) {
#if defined(__x86_64__)
  switch (level) {
    case SimdLevel::scalar:
    case SimdLevel::sse2:  // part of every x86-64
      return true;
    case SimdLevel::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case SimdLevel::avx512:
      return __builtin_cpu_supports("fma") && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512bw");
  }
#endif
  return level == SimdLevel::scalar;
}

std::vector<std::string> supported_simd_names() {
  std::vector<std::string> names;
  for (const SimdLevel level : kLevels) {
    if (is_supported(level)) {
      names.emplace_back(to_string(level));
    }
  }
  return names;
}

SimdLevel find_best_simd() {
  const char* const most = std::getenv("ARMWRIGHT_SIMD");
  const SimdLevel highest = most == nullptr || *most == '\0'
                                ? kLevels.back()
                                : find_level("SIMD level in ARMWRIGHT_SIMD", most);
  return *std::find_if(kLevels.rbegin(), kLevels.rend(),
                       [&](SimdLevel level) { return level <= highest && is_supported(level); });
}

}  // namespace armwright
