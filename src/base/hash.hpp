// Hashes of contents (SHA-256, FIPS 180-4) and checksums of records (CRC-32, ISO 3309). Both come
// from system libraries.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace armwright {

std::array<std::uint8_t, 32> calc_sha256(std::string_view bytes);
std::string calc_sha256_hex(std::string_view bytes);
// Return the hash of all pieces that `next` returns until it returns an empty one.
std::array<std::uint8_t, 32> calc_sha256(const std::function<std::string_view()>& next);
std::string calc_sha256_hex(const std::function<std::string_view()>& next);
std::uint32_t calc_crc32(std::string_view bytes);

}  // namespace armwright
