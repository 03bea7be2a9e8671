// Strict reading of TOML. A ConfigTable is one table of a document. Readers take each value out of
// it by the value's declaration (setting.hpp): the table checks type and range, and remembers which
// keys were read. refuse_unknown() then refuses the keys that no reader read.
//
// Every error that a document causes is Error{usage} with a message of the form
//   FILE:LINE: FIELD is VALUE; it must be ALLOWED
// Hostile files are refused before they are parsed: by size, depth, numbers that are not finite,
// and text that toml++ 3.3.0 crashes on.
//
// Inheritance: a top-level `extends = "other"` names a file without .toml. It lies in the same
// folder or, if that has none, in the folder of shipped files. It is read first; then tables merge
// key by key, and any other value replaces the inherited one. Overrides ("task.speed_m_per_s=2")
// are applied last. Messages about an overridden value name the override.
//
// Copies of a ConfigTable refer to the same document. Reading changes what the document remembers,
// so one thread at a time may read a document.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/setting.hpp"

namespace armwright {

class ConfigTable {
 public:
  // Reads a file whose settings are those of `settings`, which must outlive the table.
  // `overrides` are KEY=VALUE texts with dotted keys; VALUE is TOML, or a bare word that counts as
  // a string. `shipped` is the folder of shipped files. Throws Error{usage} for a document that
  // cannot be used, Error{io} for a file that cannot be read.
  static ConfigTable load(const SettingTable& settings, const std::filesystem::path& file,
                          std::span<const std::string> overrides = {},
                          const std::filesystem::path& shipped = {});
  // Reads text that is not in a file. Messages show `name` in place of the file.
  static ConfigTable parse(const SettingTable& settings, std::string_view toml,
                           const std::string& name, std::span<const std::string> overrides = {});
  // The same for documents whose keys are not declared: for to_json() and single values. The
  // tables hand out any setting.
  static ConfigTable load(const std::filesystem::path& file,
                          std::span<const std::string> overrides = {},
                          const std::filesystem::path& shipped = {});
  static ConfigTable parse(std::string_view toml, const std::string& name,
                           std::span<const std::string> overrides = {});

  // Each function that takes a declaration throws std::logic_error if the table's SettingTable does
  // not list it. Only the key counts, so that within() and among() may narrow a declaration.

  bool has(const AnySetting& setting) const;
  // Returns whether the table has the key, whatever its value. For keys that a reader refuses.
  bool has(std::string_view key) const;

  // Returns the value, or the declared default if the key is missing. Throws Error{usage} if the
  // value has another type or is out of range, or if the key is missing and has no default.
  // Integers count as numbers.
  template <class Value>
  Value get(const Setting<Value>& setting) const;
  // The same with a default that the reader found out.
  template <class Value>
  Value get_or(const Setting<Value>& setting, const std::type_identity_t<Value>& fallback) const;
  // Returns the value, or nothing if the key is missing.
  template <class Value>
  std::optional<Value> find(const Setting<Value>& setting) const;
  // Returns the index of the value in setting.choices().
  std::size_t get_choice(const Setting<std::string>& setting) const;

  // Return the tables inside this one. Throw Error{usage} if the key is missing or no table.
  ConfigTable get_table(const SettingTable& table) const;
  std::vector<ConfigTable> get_tables(const SettingTable& array) const;
  // The same, with an empty table or no tables in place of a missing key.
  ConfigTable get_table_or_empty(const SettingTable& table) const;
  std::vector<ConfigTable> get_tables_or_empty(const SettingTable& array) const;

  // Refuses every key, here and in the tables inside, that was not read. Throws Error{usage} with
  // the nearest valid key.
  void refuse_unknown() const;

  // Throws Error{usage} at this key: "FILE:LINE: KEY is VALUE; MUST". For checks that need more
  // than a range.
  [[noreturn]] void refuse(std::string_view key, std::string_view must) const;
  [[noreturn]] void refuse(const AnySetting& setting, std::string_view must) const;

  // Returns where a key stands, for errors that are found later: "FILE:LINE: KEY", or
  // "FILE:LINE: KEY[3]" for the element 3 of a list. The key and the element must exist.
  std::string describe_place(const AnySetting& setting,
                             std::optional<std::size_t> element = std::nullopt) const;
  // Records a value that the reader chose because the file leaves it open, or in place of the
  // file's. Only to_json() shows it; reading and has() do not. A whole number is
  // recorded without decimal point.
  template <class Value>
  void settle(const Setting<Value>& setting, const std::type_identity_t<Value>& value) const;
  // Leaves a key out of to_json(), whether the file has it or not. For a value that means the same
  // as the key's absence.
  void leave_out(const AnySetting& setting) const;
  // Records every value of `other` whose key this table lacks. `other` holds no tables.
  void settle_missing(const ConfigTable& other) const;

  const std::filesystem::path& file() const;  // the file that was loaded, not those it extends
  std::vector<std::filesystem::path> files() const;  // it and all files it extends, for hashing

  // Returns the table with the settled values as canonical JSON (sorted keys, no blanks). It is
  // recorded, and compared when a run is resumed.
  std::string to_json() const;

  struct Node;  // implementation

 private:
  explicit ConfigTable(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

}  // namespace armwright
