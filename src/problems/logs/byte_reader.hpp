// Reads numbers and texts from bytes, each within their end.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace armwright {

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes, bool is_big_endian = false)
      : bytes_(bytes), is_big_endian_(is_big_endian) {}

  std::size_t place() const { return place_; }
  std::size_t left() const { return bytes_.size() - place_; }
  // Returns false after the first read beyond the end; everything that was read since is 0.
  bool is_good() const { return is_good_; }

  template <typename Number>
  Number read() {
    using Bits = std::conditional_t<
        sizeof(Number) == 8, std::uint64_t,
        std::conditional_t<sizeof(Number) == 4, std::uint32_t,
                           std::conditional_t<sizeof(Number) == 2, std::uint16_t, std::uint8_t>>>;
    const std::string_view taken = take(sizeof(Number));
    Bits bits = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const auto byte =
          static_cast<unsigned char>(taken[is_big_endian_ ? taken.size() - 1 - i : i]);
      bits = static_cast<Bits>(bits | static_cast<Bits>(static_cast<Bits>(byte) << (8 * i)));
    }
    Number number;
    std::memcpy(&number, &bits, sizeof number);
    return number;
  }

  // Returns the next bytes; nothing if there are not so many.
  std::string_view take(std::uint64_t size) {
    if (size > left()) {
      is_good_ = false;
      place_ = bytes_.size();
      return {};
    }
    const std::string_view taken = bytes_.substr(place_, static_cast<std::size_t>(size));
    place_ += taken.size();
    return taken;
  }

  // Returns a text after its length, a number of 4 bytes.
  std::string_view take_text() { return take(read<std::uint32_t>()); }

 private:
  std::string_view bytes_;
  bool is_big_endian_;
  std::size_t place_ = 0;
  bool is_good_ = true;
};

}  // namespace armwright
