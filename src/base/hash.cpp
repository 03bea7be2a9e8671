#include "base/hash.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <zlib.h>

#include <stdexcept>

namespace armwright {

std::array<std::uint8_t, 32> calc_sha256(std::string_view bytes) {
  std::array<std::uint8_t, 32> digest{};
  unsigned length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1 ||
      length != digest.size()) {
    throw std::runtime_error("the system's SHA-256 failed");
  }
  return digest;
}

std::string calc_sha256_hex(std::string_view bytes) {
  std::string text;
  for (const std::uint8_t byte : calc_sha256(bytes)) {
    text += fmt::format("{:02x}", byte);
  }
  return text;
}

std::uint32_t calc_crc32(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace armwright
