// Writes bags of ROS 2 for tests: messages in CDR, MCAP files and the sqlite3 storage of rosbag2.
#pragma once

#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {

// Appends numbers in the byte order of CDR messages or, without alignment, of MCAP.
class ByteWriter {
 public:
  explicit ByteWriter(bool is_big_endian = false) : is_big_endian_(is_big_endian) {}

  template <typename Number>
  void add(Number number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    for (std::size_t i = 0; i < sizeof number; ++i) {
      text_ += bytes[is_big_endian_ ? sizeof number - 1 - i : i];
    }
  }
  void add_bytes(std::string_view bytes) { text_ += bytes; }
  void add_text(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    text_ += text;
  }
  const std::string& text() const { return text_; }

 private:
  bool is_big_endian_;
  std::string text_;
};

class CdrWriter {
 public:
  explicit CdrWriter(bool is_big_endian) : writer_(is_big_endian), is_big_endian_(is_big_endian) {}

  template <typename Number>
  void add(Number number) {
    while (writer_.text().size() % sizeof number != 0) {
      writer_.add_bytes(std::string_view("\0", 1));
    }
    writer_.add(number);
  }
  void add_text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    writer_.add_bytes(std::string_view(text.c_str(), text.size() + 1));
  }
  void add_header(std::int64_t stamp_ns) {
    add(static_cast<std::int32_t>(stamp_ns / 1'000'000'000));
    add(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    add_text("base");
  }
  void add_names(const std::vector<std::string>& names) {
    add(static_cast<std::uint32_t>(names.size()));
    for (const std::string& name : names) {
      add_text(name);
    }
  }
  void add_numbers(const std::vector<double>& numbers) {
    add(static_cast<std::uint32_t>(numbers.size()));
    for (const double number : numbers) {
      add(number);
    }
  }
  // A trajectory_msgs/JointTrajectoryPoint.
  void add_point(const std::vector<double>& positions, const std::vector<double>& velocities,
                 const std::vector<double>& efforts) {
    add_numbers(positions);
    add_numbers(velocities);
    add_numbers({});
    add_numbers(efforts);
    add(std::int32_t{0});
    add(std::uint32_t{0});
  }
  std::string message() const {
    return std::string(is_big_endian_ ? std::string_view("\0\0\0\0", 4)
                                      : std::string_view("\0\1\0\0", 4)) +
           writer_.text();
  }

 private:
  ByteWriter writer_;
  bool is_big_endian_;
};

inline std::string pack_zstd(const std::string& text) {
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 1));
  return packed;
}

inline std::string pack_lz4(const std::string& text) {
  std::string packed(LZ4F_compressFrameBound(text.size(), nullptr), '\0');
  packed.resize(
      LZ4F_compressFrame(packed.data(), packed.size(), text.data(), text.size(), nullptr));
  return packed;
}

struct WrittenTopic {
  std::string name, type, definition = "";
  std::string encoding = "cdr";
};
struct WrittenMessage {
  std::size_t topic;
  std::int64_t log_time_ns;
  std::string data;
};

inline std::string make_record(std::uint8_t kind, const std::string& content) {
  ByteWriter record;
  record.add(kind);
  record.add(static_cast<std::uint64_t>(content.size()));
  return record.text() + content;
}

inline constexpr std::string_view kMcapMark("\x89MCAP0\r\n", 8);

// `compression` is "", "lz4", "zstd" or "none": chunks with this compression, or no chunks.
inline std::string make_mcap(const std::vector<WrittenTopic>& topics,
                             const std::vector<WrittenMessage>& messages,
                             const std::string& compression) {
  ByteWriter header;
  header.add_text("ros2");
  header.add_text("test");
  std::string file = std::string(kMcapMark) + make_record(1, header.text());
  std::string records;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    ByteWriter schema, channel;
    schema.add(static_cast<std::uint16_t>(i + 1));
    schema.add_text(topics[i].type);
    schema.add_text(topics[i].definition.empty() ? "" : "ros2msg");
    schema.add_text(topics[i].definition);
    channel.add(static_cast<std::uint16_t>(i));
    channel.add(static_cast<std::uint16_t>(i + 1));
    channel.add_text(topics[i].name);
    channel.add_text(topics[i].encoding);
    channel.add(std::uint32_t{0});
    records += make_record(3, schema.text()) + make_record(4, channel.text());
  }
  const auto flush = [&] {
    if (compression == "none") {
      file += records;
    } else {
      ByteWriter chunk;
      chunk.add(std::uint64_t{0});
      chunk.add(std::uint64_t{0});
      chunk.add(static_cast<std::uint64_t>(records.size()));
      chunk.add(calc_crc32(records));
      chunk.add_text(compression);
      const std::string packed = compression == "zstd"  ? pack_zstd(records)
                                 : compression == "lz4" ? pack_lz4(records)
                                                        : records;
      chunk.add(static_cast<std::uint64_t>(packed.size()));
      chunk.add_bytes(packed);
      file += make_record(6, chunk.text()) + make_record(7, "index");
    }
    records.clear();
  };
  for (std::size_t i = 0; i < messages.size(); ++i) {
    ByteWriter message;
    message.add(static_cast<std::uint16_t>(messages[i].topic));
    message.add(static_cast<std::uint32_t>(i));
    message.add(messages[i].log_time_ns);
    message.add(messages[i].log_time_ns);
    message.add_bytes(messages[i].data);
    records += make_record(5, message.text());
    if (i % 100 == 99) {
      flush();
    }
  }
  flush();
  ByteWriter footer;
  footer.add(std::uint64_t{0});
  footer.add(std::uint64_t{0});
  footer.add(std::uint32_t{0});
  return file + make_record(15, std::string(4, '\0')) + make_record(2, footer.text()) +
         std::string(kMcapMark);
}

// Returns the content of a database as rosbag2 makes it.
inline std::string make_sqlite_bag(const std::vector<WrittenTopic>& topics,
                                   const std::vector<WrittenMessage>& messages) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "bag.db3";
  sqlite3* database = nullptr;
  sqlite3_open(file.c_str(), &database);
  const auto run = [&](const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
  };
  run("PRAGMA journal_mode = WAL; BEGIN;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
      "NOT "
      "NULL, data BLOB NOT NULL);"
      "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding "
      "TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT);");
  for (std::size_t i = 0; i < topics.size(); ++i) {
    run("INSERT INTO topics VALUES(" + std::to_string(i + 1) + ", '" + topics[i].name + "', '" +
        topics[i].type + "', '" + topics[i].encoding + "', '')");
    if (!topics[i].definition.empty()) {
      run("INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition) "
          "VALUES('" +
          topics[i].type + "', 'ros2msg', '" + topics[i].definition + "')");
    }
  }
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                     -1, &insert, nullptr);
  for (const WrittenMessage& message : messages) {
    sqlite3_bind_int64(insert, 1, static_cast<sqlite3_int64>(message.topic + 1));
    sqlite3_bind_int64(insert, 2, message.log_time_ns);
    sqlite3_bind_blob(insert, 3, message.data.data(), static_cast<int>(message.data.size()),
                      SQLITE_STATIC);
    sqlite3_step(insert);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  run("COMMIT");
  sqlite3_close(database);
  return read_file(file, std::size_t{1} << 30);
}

}  // namespace armwright
