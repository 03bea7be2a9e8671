// Reads MCAP from front to back, without its index: what a recorder could not finish has none.

#include <fmt/format.h>

#include <array>
#include <map>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/read_limit.hpp"
#include "problems/logs/bag.hpp"
#include "problems/logs/byte_reader.hpp"
#include "problems/logs/decompression.hpp"
#include "problems/logs/recording.hpp"

namespace armwright {
namespace {

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kLargestChunk_bytes = std::size_t{1} << 30;

enum class Record : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
};

struct Schema {
  std::string type, definition;
};

class McapReader {
 public:
  McapReader(std::string_view content, const std::string& file) : content_(content) {
    bag_.file = file;
  }

  Bag read() {
    ByteReader reader(content_);
    reader.take(kMcapMagic.size());
    bool is_first = true;
    while (true) {
      const std::size_t begin = reader.place();
      const auto kind = static_cast<Record>(reader.read<std::uint8_t>());
      const auto size = reader.read<std::uint64_t>();
      const std::string_view record = reader.take(size);
      if (!reader.is_good()) {
        fail(
            fmt::format("the file ends at byte {}, within the record that begins at byte {}, or "
                        "without a footer: the recording was not finished; the tool mcap repairs "
                        "such files: mcap recover FILE -o REPAIRED",
                        content_.size(), begin));
      }
      const std::string where = fmt::format("the record at byte {}", begin);
      if (is_first && kind != Record::header) {
        fail(where + " is no header; the file is damaged");
      }
      is_first = false;
      if (kind == Record::footer) {
        if (reader.take(kMcapMagic.size()) != kMcapMagic || reader.left() != 0) {
          fail(
              fmt::format("the file does not end behind its footer (byte {}) with MCAP's mark; the "
                          "file is damaged",
                          begin));
        }
        return std::move(bag_);
      }
      if (kind == Record::chunk) {
        read_chunk(record, where);
      } else {
        read_record(kind, record, where);
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", bag_.file, what));
  }

  void check_end(const ByteReader& reader, const std::string& where) const {
    if (!reader.is_good()) {
      fail(where + " is shorter than its own fields; the file is damaged");
    }
  }

  void read_chunk(std::string_view record, const std::string& where) {
    ByteReader reader(record);
    reader.take(16);  // the times of the first and the last message
    const auto size = reader.read<std::uint64_t>();
    const auto checksum = reader.read<std::uint32_t>();
    const std::string_view compression = reader.take_text();
    const std::string_view packed = reader.take(reader.read<std::uint64_t>());
    check_end(reader, where);
    if (size > kLargestChunk_bytes) {
      fail(fmt::format("{} is a chunk of {} bytes; at most {} are possible", where, size,
                       kLargestChunk_bytes));
    }
    const std::string chunk_where = fmt::format("{}: {}", bag_.file, where);
    std::string unpacked;
    if (compression == "zstd") {
      unpacked = decompress_zstd(packed, static_cast<std::size_t>(size), chunk_where);
    } else if (compression == "lz4") {
      unpacked = decompress_lz4(packed, static_cast<std::size_t>(size), chunk_where);
    } else if (!compression.empty()) {
      fail(fmt::format("{} is compressed by {}; possible are zstd, lz4 and none", where,
                       quote_name(compression)));
    }
    const std::string_view records = compression.empty() ? packed : std::string_view(unpacked);
    if (records.size() != size) {
      fail(fmt::format("{} is a chunk of {} bytes in place of {}; the file is damaged", where,
                       records.size(), size));
    }
    if (checksum != 0 && calc_crc32(records) != checksum) {
      fail(where + " is a chunk with a wrong checksum; the file is damaged");
    }
    ByteReader inner(records);
    while (inner.left() > 0) {
      const std::string place = fmt::format("{}, in its chunk at byte {},", where, inner.place());
      const auto kind = static_cast<Record>(inner.read<std::uint8_t>());
      const std::string_view content = inner.take(inner.read<std::uint64_t>());
      check_end(inner, place);
      if (kind == Record::chunk) {
        fail(place + " is a chunk in a chunk; the file is damaged");
      }
      read_record(kind, content, place);
    }
  }

  void read_record(Record kind, std::string_view record, const std::string& where) {
    ByteReader reader(record);
    if (kind == Record::schema) {
      const auto id = reader.read<std::uint16_t>();
      std::string type(reader.take_text());
      const bool is_text = reader.take_text() == "ros2msg";
      const std::string_view definition = reader.take_text();
      check_end(reader, where);
      schemas_[id] = {std::move(type), is_text ? std::string(definition) : ""};
    } else if (kind == Record::channel) {
      const auto id = reader.read<std::uint16_t>();
      const auto schema = schemas_.find(reader.read<std::uint16_t>());
      std::string topic(reader.take_text());
      std::string encoding(reader.take_text());
      check_end(reader, where);
      const bool is_known = schema != schemas_.end();
      channels_[id] =
          bag_.add_topic(std::move(topic), is_known ? schema->second.type : "", std::move(encoding),
                         is_known ? schema->second.definition : "");
    } else if (kind == Record::message) {
      const auto channel = channels_.find(reader.read<std::uint16_t>());
      reader.take(4);  // the number of the message
      const auto log_time_ns = reader.read<std::int64_t>();
      reader.take(8);  // the time of publication
      check_end(reader, where);
      if (channel == channels_.end()) {
        fail(where + " is a message of a channel that the file does not describe; it is damaged");
      }
      if (++messages_ % 256 == 0) {
        check_reading();
      }
      bag_.add_message(channel->second, log_time_ns, reader.take(reader.left()));
    }
  }

  std::string_view content_;
  Bag bag_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  // the number of the topic
  std::size_t messages_ = 0;
};

}  // namespace

bool is_mcap(std::string_view content) {
  return content.starts_with(kMcapMagic);
}

Bag read_mcap(std::string_view content, const std::string& file) {
  return McapReader(content, file).read();
}

}  // namespace armwright
