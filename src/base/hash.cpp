#include "base/hash.hpp"

#include <fmt/ranges.h>
#include <openssl/evp.h>
#include <zlib.h>

#include <memory>
#include <stdexcept>
#include <utility>

namespace armwright {

std::array<std::uint8_t, 32> calc_sha256(const std::function<std::string_view()>& next) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  bool is_good = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (auto piece = next(); is_good && !piece.empty(); piece = next()) {
    is_good = EVP_DigestUpdate(context.get(), piece.data(), piece.size()) == 1;
  }
  std::array<std::uint8_t, 32> digest{};
  if (!is_good || EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) != 1) {
    throw std::runtime_error("the system's SHA-256 failed");
  }
  return digest;
}

std::array<std::uint8_t, 32> calc_sha256(std::string_view bytes) {
  return calc_sha256([&] { return std::exchange(bytes, {}); });
}

std::string calc_sha256_hex(const std::function<std::string_view()>& next) {
  return fmt::format("{:02x}", fmt::join(calc_sha256(next), ""));
}

std::string calc_sha256_hex(std::string_view bytes) {
  return calc_sha256_hex([&] { return std::exchange(bytes, {}); });
}

std::uint32_t calc_crc32(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace armwright
