// Reads the sqlite3 storage of rosbag2 in memory, so that SQLite neither locks nor changes the file.

#include <fmt/format.h>
#include <sqlite3.h>

#include <exception>
#include <map>
#include <memory>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/logs/bag.hpp"
#include "problems/logs/byte_reader.hpp"
#include "problems/logs/recording.hpp"

namespace armwright {
namespace {

constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);
constexpr std::size_t kHeader_bytes = 100;
constexpr int kLargestValue_bytes = 64 << 20;
constexpr int kStepsBetweenLooks = 10'000;

struct CloseDatabase {
  void operator()(sqlite3* handle) const { sqlite3_close(handle); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

class BagDatabase {
 public:
  BagDatabase(std::string& content, std::string file) : file_(std::move(file)) {
    sqlite3* handle = nullptr;
    const int code =
        sqlite3_open_v2(":memory:", &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY, nullptr);
    handle_.reset(handle);
    check(code);
    // The database comes from outside: nothing in it may run but these queries.
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kLargestValue_bytes);
    for (const auto& [option, value] :
         {std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1}, std::pair{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
          std::pair{SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
          std::pair{SQLITE_DBCONFIG_ENABLE_VIEW, 0}}) {
      check(sqlite3_db_config(handle, option, value, nullptr));
    }
    sqlite3_progress_handler(handle, kStepsBetweenLooks, &BagDatabase::look, this);
    const auto size = static_cast<sqlite3_int64>(content.size());
    check(sqlite3_deserialize(handle, "main", reinterpret_cast<unsigned char*>(content.data()),
                              size, size, SQLITE_DESERIALIZE_READONLY));
  }

  // Calls `take` for each row.
  template <typename Take>
  void query(const char* sql, const Take& take) {
    sqlite3_stmt* raw = nullptr;
    check(sqlite3_prepare_v2(handle_.get(), sql, -1, &raw, nullptr));
    const std::unique_ptr<sqlite3_stmt, FinalizeStatement> statement(raw);
    int code = 0;
    while ((code = sqlite3_step(raw)) == SQLITE_ROW) {
      take(raw);
    }
    check(code);
  }

  static std::string_view get_bytes(sqlite3_stmt* row, int column) {
    const void* bytes = sqlite3_column_blob(row, column);
    const int size = sqlite3_column_bytes(row, column);
    return bytes == nullptr
               ? std::string_view()
               : std::string_view(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
  }

 private:
  static int look(void* self) {
    try {
      check_reading();
      return 0;
    } catch (...) {
      static_cast<BagDatabase*>(self)->held_ = std::current_exception();
      return 1;
    }
  }

  void check(int code) const {
    if (held_) {
      std::rethrow_exception(held_);
    }
    if (code != SQLITE_OK && code != SQLITE_DONE) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: SQLite cannot read it: {}; the file is damaged or no bag of "
                              "rosbag2",
                              file_, sanitize(sqlite3_errmsg(handle_.get()))));
    }
  }

  std::string file_;
  std::unique_ptr<sqlite3, CloseDatabase> handle_;
  std::exception_ptr held_;
};

// The header of a database says how many pages there are.
void check_size(std::string_view content, const std::string& file) {
  ByteReader reader(content, true);
  reader.take(16);
  const auto stored = reader.read<std::uint16_t>();
  const std::uint64_t page_bytes = stored == 1 ? 65536 : stored;
  reader.take(10);
  const std::uint64_t pages = reader.read<std::uint32_t>();
  if (content.size() < kHeader_bytes || content.size() < pages * page_bytes) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: the file ends at byte {}, but its database has {} bytes: it was cut "
                    "off; copy or record it again",
                    file, content.size(), std::max<std::uint64_t>(pages * page_bytes, 100)));
  }
}

}  // namespace

bool is_sqlite(std::string_view content) {
  return content.starts_with(kSqliteMagic);
}

Bag read_sqlite_bag(std::string& content, const std::string& file) {
  check_size(content, file);
  // "Write-ahead log": SQLite opens such a database only beside its log. The recorder has merged it.
  content[18] = content[19] = 1;
  BagDatabase database(content, file);
  Bag bag;
  bag.file = file;
  int tables = 0;
  bool has_definitions = false;
  database.query(
      "SELECT name FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages', "
      "'message_definitions')",
      [&](sqlite3_stmt* row) {
        const bool is_definitions = BagDatabase::get_bytes(row, 0) == "message_definitions";
        has_definitions = has_definitions || is_definitions;
        tables += is_definitions ? 0 : 1;
      });
  if (tables < 2) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: is a database of SQLite without the tables 'topics' and 'messages', "
                    "so it is no bag of rosbag2",
                    file));
  }
  std::map<std::string, std::string> definitions;
  if (has_definitions) {
    database.query(
        "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = "
        "'ros2msg'",
        [&](sqlite3_stmt* row) {
          definitions.emplace(BagDatabase::get_bytes(row, 0), BagDatabase::get_bytes(row, 1));
        });
  }
  std::map<sqlite3_int64, std::size_t> topics;
  database.query("SELECT id, name, type, serialization_format FROM topics", [&](sqlite3_stmt* row) {
    const std::string type(BagDatabase::get_bytes(row, 2));
    const auto definition = definitions.find(type);
    topics[sqlite3_column_int64(row, 0)] =
        bag.add_topic(std::string(BagDatabase::get_bytes(row, 1)), type,
                      std::string(BagDatabase::get_bytes(row, 3)),
                      definition == definitions.end() ? "" : definition->second);
  });
  std::size_t count = 0;
  database.query("SELECT topic_id, timestamp, data FROM messages", [&](sqlite3_stmt* row) {
    const auto topic = topics.find(sqlite3_column_int64(row, 0));
    ++count;
    if (topic == topics.end()) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: row {} of the table 'messages' belongs to no topic; the file is "
                              "damaged",
                              file, count));
    }
    bag.add_message(topic->second, sqlite3_column_int64(row, 1), BagDatabase::get_bytes(row, 2));
  });
  return bag;
}

}  // namespace armwright
