// The tree behind ConfigTable (config.hpp): what a TOML file, the files it extends and the
// overrides say, each value with the place where it really stands. Internal to the base room;
// everything else uses ConfigTable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/config.hpp"

namespace armwright::config {

inline constexpr std::size_t kFileLimit_bytes = std::size_t{1} << 20;
inline constexpr std::size_t kDepthLimit = 64;  // of nested tables and arrays, dotted keys included
inline constexpr std::size_t kExtendsLimit = 8;

// One text that was parsed: a file, or one override.
struct Source {
  std::string name;  // as messages give it: the path, or "--set KEY=VALUE"
  std::string text;
  bool is_override = false;
};

struct Place {
  const Source* source = nullptr;
  std::size_t line = 0;
  std::string describe() const;  // "FILE:LINE", or "--set KEY=VALUE"
};

enum class Kind { string, integer, number, boolean, date, array, table };

struct Value {
  Kind kind = Kind::table;
  Place place;
  std::string_view written;  // as it stands in its source's text; empty for a table made by a
                             // header or a dotted key
  std::string string;        // also a date, as written
  std::int64_t integer = 0;
  double number = 0;
  bool boolean = false;
  std::vector<Value> items;
  std::map<std::string, std::unique_ptr<Value>, std::less<>> keys;
  mutable std::vector<std::string>
      asked;  // of a table: the keys that were asked for, in that order

  std::string describe() const;            // the value as written, shortened and printable
  std::string describe_with_type() const;  // the same and what it is: "4, an integer"
};

struct Document {
  std::filesystem::path file;
  std::vector<std::filesystem::path> files;
  std::deque<Source> sources;  // a deque, since places point into it
  Value root;
  mutable Value settled;  // what readers settled (ConfigTable::settle), a table
};

std::shared_ptr<const Document> load_document(const std::filesystem::path& file,
                                              std::span<const std::string> overrides,
                                              const std::filesystem::path& shipped);
std::shared_ptr<const Document> parse_document(std::string_view toml, const std::string& name,
                                               std::span<const std::string> overrides);

// Refuses what toml++ 3.3.0 does not report but runs into, a stack overflow or undefined behaviour:
// text deeper than kDepthLimit; characters beyond ASCII where it may take them for keys or blanks;
// headers without a name, values that begin in the middle of others, dates with half a time (all
// found by a fuzzer). Invalid UTF-8 as well. Error{usage} at the line where it stands.
void check_text(const Source& source);

// "task" and "speed_m_per_s" as "task.speed_m_per_s"; a key that TOML wants quoted is quoted, a
// long one is shortened.
std::string join_path(std::string_view path, std::string_view key);
// Printable, and at most some sixty bytes of it.
std::string shorten(std::string_view text);
bool is_bare_key(std::string_view key);

[[noreturn]] void fail(const Place& place, std::string_view message);  // Error{usage}

}  // namespace armwright::config
