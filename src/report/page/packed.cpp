#include "report/page/packed.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <string>
#include <string_view>

namespace armwright {
namespace {

void append_little_endian(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<char>(static_cast<unsigned char>(value >> shift)));
  }
}

std::string encode_base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=');
    }
  }
  return text;
}

}  // namespace

nlohmann::json pack_f32(std::span<const float> values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const float value : values) {
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
  }
  return {{"f32", encode_base64(bytes)}};
}

nlohmann::json pack_u32(std::span<const std::uint32_t> values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const std::uint32_t value : values) {
    append_little_endian(bytes, value);
  }
  return {{"u32", encode_base64(bytes)}};
}

}  // namespace armwright
