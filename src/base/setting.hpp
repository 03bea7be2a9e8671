// Declarations of settings. A setting is one key of a configuration file. Its declaration holds the
// key, the type, the unit, the range, the default and the meaning. Readers hand the declaration to
// ConfigTable::get() (config.hpp), which checks the value against it. The messages about wrong
// values and the page of settings (docs/reference/configuration.md) use the same declaration.
//
// A SettingTable lists the settings of one table of a file, and the tables inside it. It is the
// contents of the page of settings. ConfigTable reads no setting that its SettingTable lacks.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace armwright {

// The numbers that a setting may have. Both ends belong to the range, except an open lower end.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false;  // true: the value must be above `lower`

  bool contains(double value) const {
    return (lower_open ? value > lower : value >= lower) && value <= upper;
  }
};

// The declaration without the type of its default.
struct AnySetting {
  enum class Kind : std::uint8_t { text, integer, number, boolean, texts, numbers };

  Kind kind = Kind::text;
  std::string key;   // "speed_m_per_s", without the table that it stands in
  std::string unit;  // "m/s", from the end of the key; empty for a setting without unit
  Range range;       // of a number, of an integer, or of each number of an array
  // Returns the texts that are allowed. Empty if any text is allowed.
  std::function<std::vector<std::string>()> choices;
  // The default as TOML writes it. Empty if the setting has none: it is required, or the meaning
  // says what its absence does.
  std::string default_text;
  std::string meaning;  // one line for the page of settings

  // Returns what a value must be, as messages say it: "a finite number >= 0.01 and <= 100".
  std::string describe_allowed() const;
};

inline constexpr std::nullopt_t kNoDefault = std::nullopt;

// Returns a function that returns these texts, for settings that are one of a few texts.
inline std::function<std::vector<std::string>()> one_of(std::vector<std::string> texts) {
  return [texts = std::move(texts)] { return texts; };
}

// The declaration of one setting. `Value` is bool, int, std::int64_t, double, std::string,
// std::vector<double> or std::vector<std::string>.
template <class Value>
struct Setting : AnySetting {
  // Declares a number, an integer or an array of numbers.
  Setting(std::string name, Range allowed, std::optional<Value> otherwise, std::string words);
  // Declares a text that is one of those that `allowed` returns.
  Setting(std::string name, std::function<std::vector<std::string>()> allowed,
          std::optional<Value> otherwise, std::string words);
  // Declares a value without limits: a boolean, any text, any number or an array of texts.
  Setting(std::string name, std::optional<Value> otherwise, std::string words);

  // Returns the declaration with another range or other choices. For limits that depend on the
  // value of another setting.
  Setting within(Range narrower) const;
  Setting among(std::vector<std::string> names) const;

  std::optional<Value> fallback;  // the default
};

// One table of a configuration file, or the file itself. Refers to declarations that live as long
// as the program.
struct SettingTable {
  std::string key;        // "task", without the table that it stands in; empty: the file itself
  bool is_array = false;  // true: an array of tables, [[KEY]]
  std::vector<const AnySetting*> settings = {};
  std::vector<const SettingTable*> tables = {};
  // `armwright list settings` puts this prefix before the names of the file's settings. A file that
  // it does not list has none.
  std::optional<std::string> listed_as = {};
};

struct ListedSetting {
  std::string path;  // "task.speed_m_per_s"; in an array of tables "requirement[].use"
  const AnySetting* setting;
};

// Returns every setting of the file, each table before the tables inside it.
std::vector<ListedSetting> list_settings(const SettingTable& file);

// Returns the unit that a key ends with: "speed_m_per_s" has "m/s". Empty for a key without unit.
std::string find_key_unit(std::string_view key);

// Returns what a number of this range must be: "a finite number >= 0".
std::string describe_number(const Range& range);

}  // namespace armwright
