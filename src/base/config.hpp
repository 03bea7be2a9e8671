// Strict reading of TOML. A ConfigTable hands out each value with its type and range checked and
// remembers what was asked for; what is left over is unknown and refused, with the nearest valid
// key. Every message reads FILE:LINE: field is VALUE; it must be ALLOWED. Hostile files (size,
// depth, non-finite numbers; toml++ 3.3.0 crashes on some) are refused beforehand.
//
// Inheritance: a top-level `extends = "other"` names a file (without .toml) of the same folder or,
// if there is none, of the folder of shipped ones, that is read first; tables merge, anything else
// replaces. Overrides ("task.speed_m_per_s=2") come last
// and are named as such in messages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false;  // true: the value must be strictly above `lower`
};

// What a reader asked a document for: the rows of a reference of its keys are made of these, and so
// say what is really read.
struct AskedKey {
  std::string path;      // "task.speed_m_per_s"; of the tables of an array "requirement[].use"
  std::string allowed;   // "a finite number >= 0.01 and <= 100"; empty: it was asked only whether
                         // the key is there, which it was not
  std::string fallback;  // as in TOML; empty: the reader has none, or only knows it elsewhere
};

class ConfigTable {
 public:
  // `overrides` are KEY=VALUE texts with dotted keys; VALUE is TOML, or a bare word taken as a
  // string. `shipped`: where files that are extended are looked for beside the file's own folder.
  static ConfigTable load(const std::filesystem::path& file,
                          std::span<const std::string> overrides = {},
                          const std::filesystem::path& shipped = {});
  // For tests and for text that is not in a file; `name` stands where messages name the file.
  static ConfigTable parse(std::string_view toml, const std::string& name,
                           std::span<const std::string> overrides = {});

  bool has(std::string_view key) const;

  // Required values. Each throws Error{usage} if the key is missing, of another type or out of
  // range.
  std::string get_string(std::string_view key) const;
  std::string get_choice(std::string_view key, std::span<const std::string> valid) const;
  double get_number(std::string_view key, Range range = {}) const;  // integers count as numbers
  std::int64_t get_integer(std::string_view key, std::int64_t lower, std::int64_t upper) const;
  bool get_bool(std::string_view key) const;
  std::vector<double> get_numbers(std::string_view key, Range range = {}) const;
  std::vector<std::string> get_strings(std::string_view key) const;
  ConfigTable get_table(std::string_view key) const;
  std::vector<ConfigTable> get_tables(std::string_view key) const;  // an array of tables

  // The same with a default for a missing key (an empty table, for get_table_or_empty and
  // get_tables_or_empty).
  std::string get_string(std::string_view key, std::string_view fallback) const;
  std::string get_choice(std::string_view key, std::span<const std::string> valid,
                         std::string_view fallback) const;
  double get_number_or(std::string_view key, double fallback, Range range = {}) const;
  std::int64_t get_integer_or(std::string_view key, std::int64_t fallback, std::int64_t lower,
                              std::int64_t upper) const;
  bool get_bool_or(std::string_view key, bool fallback) const;
  ConfigTable get_table_or_empty(std::string_view key) const;
  std::vector<ConfigTable> get_tables_or_empty(std::string_view key) const;

  // Refuses every key, here and below, that nobody asked for.
  void refuse_unknown() const;

  // An Error{usage} at this key: "FILE:LINE: KEY is VALUE; MUST". For checks that need more than a
  // range.
  [[noreturn]] void refuse(std::string_view key, std::string_view must) const;

  // Everything that was asked for so far, of the whole document, by path.
  std::vector<AskedKey> asked() const;

  const std::filesystem::path& file() const;  // the file that was loaded, not the ones it extends
  std::vector<std::filesystem::path> files() const;  // it and all it extends, for hashing

  // The resolved table as canonical JSON (sorted keys): what is recorded and compared on resume.
  std::string to_json() const;

  struct Node;  // implementation

 private:
  explicit ConfigTable(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

}  // namespace armwright
