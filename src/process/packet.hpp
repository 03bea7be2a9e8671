// Numbers and texts as bytes between two processes of the same program, in the machine's byte order
// and without versions. A read beyond the end throws.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace armwright {

// A received message does not have the expected content.
class PacketError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class PacketWriter {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void put(Number value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void put(std::string_view text) {
    put(std::uint64_t{text.size()});
    bytes_.append(text);
  }
  void put(std::span<const double> numbers) {
    put(std::uint64_t{numbers.size()});
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class PacketReader {
 public:
  explicit PacketReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number> Number get() {
    if constexpr (std::is_same_v<Number, bool>) {  // only 0 and 1 are valid
      const auto byte = get<std::uint8_t>();
      if (byte > 1) {
        throw PacketError("a message has a truth value that is none");
      }
      return byte == 1;
    } else {
      Number value{};
      std::memcpy(&value, take(sizeof value).data(), sizeof value);
      return value;
    }
  }
  std::string get_text() {
    const auto size = get<std::uint64_t>();
    return std::string(take(size));
  }
  std::vector<double> get_numbers() {
    const auto count = get<std::uint64_t>();
    if (count > bytes_.size() / sizeof(double)) {
      throw PacketError("a message ends early");
    }
    std::vector<double> numbers(count);
    const std::string_view bytes = take(count * sizeof(double));
    if (count > 0) {
      std::memcpy(numbers.data(), bytes.data(), bytes.size());
    }
    return numbers;
  }

 private:
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) {
      throw PacketError("a message ends early");
    }
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  std::string_view bytes_;
};

}  // namespace armwright
