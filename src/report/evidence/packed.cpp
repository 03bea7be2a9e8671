#include "report/evidence/packed.hpp"

#include <bit>
#include <string>
#include <vector>

#include "base/base64.hpp"

namespace armwright {
namespace {

// Little-endian, whatever the machine is.
template <typename Number>
std::string pack(std::span<const Number> values) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * values.size());
  for (const Number value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  return to_base64(bytes);
}

}  // namespace

nlohmann::json pack_f32(std::span<const float> values) {
  return {{"f32", pack(values)}};
}

nlohmann::json pack_u32(std::span<const std::uint32_t> values) {
  return {{"u32", pack(values)}};
}

}  // namespace armwright
