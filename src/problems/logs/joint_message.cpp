#include "problems/logs/joint_message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "problems/logs/byte_reader.hpp"

namespace armwright {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

// A message is a sequence of numbers at places that are multiples of their sizes, counted from
// behind the first four bytes, which name the byte order.
class CdrReader {
 public:
  explicit CdrReader(std::string_view message)
      : reader_(message.substr(std::min<std::size_t>(4, message.size())), message[1] == 0) {}

  template <typename Number>
  Number read() {
    align(sizeof(Number));
    return reader_.read<Number>();
  }
  std::string_view read_text() {
    std::string_view text = reader_.take(read<std::uint32_t>());
    text.remove_suffix(text.ends_with('\0') ? 1 : 0);
    return text;
  }
  void read_numbers(std::vector<double>& numbers) {
    const auto count = read<std::uint32_t>();
    numbers.clear();
    if (count == 0) {
      return;
    }
    align(sizeof(double));
    if (count > reader_.left() / sizeof(double)) {
      reader_.take(std::numeric_limits<std::uint64_t>::max());
      return;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      numbers.push_back(reader_.read<double>());
    }
  }
  void read_texts(std::vector<std::string_view>& texts) {
    texts.clear();
    for (auto left = read<std::uint32_t>(); left > 0 && reader_.is_good(); --left) {
      texts.push_back(read_text());
    }
  }
  std::size_t left() const { return reader_.left(); }
  bool is_good() const { return reader_.is_good(); }

 private:
  void align(std::size_t size) { reader_.take((size - reader_.place() % size) % size); }
  ByteReader reader_;
};

std::string find_cdr_fault(std::string_view bytes) {
  if (bytes.size() < 4) {
    return fmt::format("it has {} bytes, which is no message in CDR", bytes.size());
  }
  if (bytes[0] != 0 || bytes[1] < 0 || bytes[1] > 1) {
    return fmt::format(
        "it begins with the bytes {:02x} {:02x}; plain CDR begins with 00 00 or 00 01",
        static_cast<unsigned char>(bytes[0]), static_cast<unsigned char>(bytes[1]));
  }
  return "";
}

void read_beginning(CdrReader& reader, JointMessage& message) {
  const auto seconds = reader.read<std::int32_t>();
  const auto nanoseconds = reader.read<std::uint32_t>();
  message.stamp_ns = seconds * kNanosecondsPerSecond + nanoseconds;
  reader.read_text();  // the frame
  reader.read_texts(message.names);
}

std::string find_end_fault(const CdrReader& reader, std::string_view bytes) {
  return reader.is_good() ? ""
                          : fmt::format(
                                "its {} bytes end within its fields; the message is cut off or "
                                "of another type",
                                bytes.size());
}

}  // namespace

std::string decode_joint_state(std::string_view bytes, JointMessage& message) {
  if (std::string fault = find_cdr_fault(bytes); !fault.empty()) {
    return fault;
  }
  CdrReader reader(bytes);
  read_beginning(reader, message);
  message.point_count = 1;
  for (const std::size_t field : {0, 1, 3}) {
    reader.read_numbers(message.points[0].fields[field]);
  }
  return find_end_fault(reader, bytes);
}

std::string decode_controller_state(std::string_view bytes,
                                    const std::vector<std::string>& point_names,
                                    JointMessage& message) {
  constexpr std::size_t kOldPoints = 3;
  constexpr std::size_t kSmallestPoint_bytes = 24;
  if (std::string fault = find_cdr_fault(bytes); !fault.empty()) {
    return fault;
  }
  CdrReader reader(bytes);
  read_beginning(reader, message);
  message.point_count = point_names.empty() ? kOldPoints : point_names.size();
  for (std::size_t i = 0; i < message.point_count; ++i) {
    for (auto& field : message.points[i].fields) {
      reader.read_numbers(field);
    }
    reader.read<std::int32_t>();  // the time from the trajectory's start
    reader.read<std::uint32_t>();
    if (point_names.empty() && i + 1 == kOldPoints && reader.left() >= kSmallestPoint_bytes) {
      message.point_count = kOldPoints + 1;
    }
  }
  return find_end_fault(reader, bytes);
}

}  // namespace armwright
