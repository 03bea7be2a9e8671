// The tree behind ConfigTable (config.hpp): the values of a TOML file, of the files that it extends
// and of the overrides, each with the place where it stands. Internal to this module; all other
// code uses ConfigTable.
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
inline constexpr std::size_t kDepthLimit = 64;   // nested tables and arrays; each dot counts as one
inline constexpr std::size_t kExtendsLimit = 8;  // files that are extended in a row

// One text that was parsed: a file, or one override.
struct Source {
  std::string name;  // as messages show it: the path, or "--set KEY=VALUE"
  std::string text;
  bool is_override = false;
};

// The line that a value stands in.
struct Place {
  const Source* source = nullptr;
  std::size_t line = 0;
  std::string describe() const;  // "FILE:LINE", or "--set KEY=VALUE"
};

enum class Kind { string, integer, number, boolean, date, array, table };

// One value of the tree.
struct Value {
  Kind kind = Kind::table;
  Place place;
  std::string_view written;  // the part of its source's text; empty for a table made by a header or
                             // a dotted key
  std::string string;        // of a string, and of a date as written
  std::int64_t integer = 0;
  double number = 0;
  bool boolean = false;
  bool is_left_out = false;  // of a settled value: to_json() lacks the key
  std::vector<Value> items;
  std::map<std::string, std::unique_ptr<Value>, std::less<>> keys;
  mutable std::vector<std::string> asked;  // of a table: keys that were read, in order of reading

  std::string describe() const;            // the value as written, shortened and printable
  std::string describe_with_type() const;  // the same with its type: "4, an integer"
};

// One document, with all sources that it was made from.
struct Document {
  std::filesystem::path file;
  std::vector<std::filesystem::path> files;  // the file and all files that it extends
  std::deque<Source> sources;  // a deque keeps its elements in place; every Place points to one
  Value root;
  mutable Value settled;  // what readers settled (ConfigTable::settle), a table
};

// Return the document, as ConfigTable::load() and ConfigTable::parse() describe.
std::shared_ptr<const Document> load_document(const std::filesystem::path& file,
                                              std::span<const std::string> overrides,
                                              const std::filesystem::path& shipped);
std::shared_ptr<const Document> parse_document(std::string_view toml, const std::string& name,
                                               std::span<const std::string> overrides);

// Refuses text on which toml++ 3.3.0 overflows the stack or has undefined behaviour, where it
// should report an error. A fuzzer found: text deeper than kDepthLimit; characters beyond ASCII
// that it may take for keys or blanks; headers without a name; values that begin in the middle of
// others; dates with half a time. Refuses invalid UTF-8 too. Throws Error{usage} with the line.
void check_text(const Source& source);

// Returns "task.speed_m_per_s" for "task" and "speed_m_per_s". A key that TOML needs quotes for is
// quoted, a long key is shortened.
std::string join_path(std::string_view path, std::string_view key);
// Returns the text in printable form, cut after 60 bytes.
std::string shorten(std::string_view text);
bool is_bare_key(std::string_view key);

// Throws Error{usage} "PLACE: MESSAGE".
[[noreturn]] void fail(const Place& place, std::string_view message);

// Appends a value as canonical JSON (sorted keys, shortest exact numbers) to `out`. Values of
// `settled`, which may be null, replace its own.
void append_json(const Value& value, const Value* settled, std::string& out);

// Return a value to settle. A whole number becomes an integer, as a file would show it.
Value make_settled(const std::string& text);
Value make_settled(std::int64_t integer);
Value make_settled(int integer);
Value make_settled(double number);
Value make_settled(bool boolean);
Value make_settled(const std::vector<double>& numbers);
Value make_settled(const std::vector<std::string>& texts);

// Returns a copy of a value that is no table.
Value copy_value(const Value& value);

}  // namespace armwright::config
