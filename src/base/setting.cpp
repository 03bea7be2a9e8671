#include "base/setting.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/text.hpp"

namespace armwright {
namespace {

template <class Value>
constexpr AnySetting::Kind find_kind() {
  if constexpr (std::is_same_v<Value, bool>) {
    return AnySetting::Kind::boolean;
  } else if constexpr (std::is_integral_v<Value>) {
    return AnySetting::Kind::integer;
  } else if constexpr (std::is_same_v<Value, double>) {
    return AnySetting::Kind::number;
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return AnySetting::Kind::text;
  } else {
    return std::is_same_v<Value, std::vector<double>> ? AnySetting::Kind::numbers
                                                      : AnySetting::Kind::texts;
  }
}

template <class Value>
std::string write_default(const Value& value) {
  if constexpr (std::is_same_v<Value, double>) {
    return format_exact(value);
  } else {
    return nlohmann::json(value).dump();  // TOML writes these values in the same way
  }
}

template <class Value>
AnySetting declare(std::string name, const std::optional<Value>& otherwise, std::string words) {
  AnySetting setting;
  setting.kind = find_kind<Value>();
  setting.unit = find_key_unit(name);
  setting.key = std::move(name);
  setting.default_text = otherwise ? write_default(*otherwise) : "";
  setting.meaning = std::move(words);
  return setting;
}

std::string describe_integer(const Range& range) {
  const bool from = std::isfinite(range.lower);
  const bool to = std::isfinite(range.upper);
  const auto write = [](double end) { return fmt::format("{}", static_cast<std::int64_t>(end)); };
  if (from && to) {
    return fmt::format("an integer from {} to {}", write(range.lower), write(range.upper));
  }
  return from ? "an integer >= " + write(range.lower)
              : (to ? "an integer <= " + write(range.upper) : "an integer");
}

void append_settings(const SettingTable& table, const std::string& prefix,
                     std::vector<ListedSetting>& all) {
  for (const AnySetting* setting : table.settings) {
    all.push_back({prefix + setting->key, setting});
  }
  for (const SettingTable* inner : table.tables) {
    append_settings(*inner, prefix + inner->key + (inner->is_array ? "[]." : "."), all);
  }
}

}  // namespace

std::string AnySetting::describe_allowed() const {
  switch (kind) {
    case AnySetting::Kind::text:
      return choices ? fmt::format("one of these strings: {}", join(choices(), ", ")) : "a string";
    case AnySetting::Kind::integer:
      return describe_integer(range);
    case AnySetting::Kind::number:
      return describe_number(range);
    case AnySetting::Kind::boolean:
      return "true or false";
    case AnySetting::Kind::texts:
      return "an array of strings";
    case AnySetting::Kind::numbers:
      return fmt::format("an array, each element of it {}", describe_number(range));
  }
  return "";
}

template <class Value>
Setting<Value>::Setting(std::string name, Range allowed, std::optional<Value> otherwise,
                        std::string words)
    : Setting(std::move(name), std::move(otherwise), std::move(words)) {
  range = allowed;
}

template <class Value>
Setting<Value>::Setting(std::string name, std::function<std::vector<std::string>()> allowed,
                        std::optional<Value> otherwise, std::string words)
    : Setting(std::move(name), std::move(otherwise), std::move(words)) {
  choices = std::move(allowed);
}

template <class Value>
Setting<Value>::Setting(std::string name, std::optional<Value> otherwise, std::string words)
    : AnySetting(declare(std::move(name), otherwise, std::move(words))),
      fallback(std::move(otherwise)) {}

template <class Value>
Setting<Value> Setting<Value>::within(Range narrower) const {
  Setting copy = *this;
  copy.range = narrower;
  return copy;
}

template <class Value>
Setting<Value> Setting<Value>::among(std::vector<std::string> names) const {
  Setting copy = *this;
  copy.choices = one_of(std::move(names));
  return copy;
}

template struct Setting<bool>;
template struct Setting<int>;
template struct Setting<std::int64_t>;
template struct Setting<double>;
template struct Setting<std::string>;
template struct Setting<std::vector<double>>;
template struct Setting<std::vector<std::string>>;

std::vector<ListedSetting> list_settings(const SettingTable& file) {
  std::vector<ListedSetting> all;
  append_settings(file, "", all);
  return all;
}

std::string find_key_unit(std::string_view key) {
  // Longer endings come first: each ends like the next shorter one.
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"_n_m_s_per_rad", "N m s/rad"},
      {"_n_m_per_rad", "N m/rad"},
      {"_n_m_per_kg", "N m/kg"},
      {"_m_per_s2", "m/s^2"},
      {"_rad_per_s", "rad/s"},
      {"_rad_per_m", "rad/m"},
      {"_n_s_per_m", "N s/m"},
      {"_n_per_m", "N/m"},
      {"_kg_per_m3", "kg/m^3"},
      {"_kg_m2", "kg m^2"},
      {"_m_per_s", "m/s"},
      {"_n_m", "N m"},
      {"_rad", "rad"},
      {"_kg", "kg"},
      {"_m2", "m^2"},
      {"_m3", "m^3"},
      {"_pa", "Pa"},
      {"_m", "m"},
      {"_n", "N"},
      {"_s", "s"},
      {"_j", "J"},
      {"_hz", "Hz"},
  };
  for (const auto& [ending, unit] : kUnits) {
    if (key.ends_with(ending)) {
      return std::string(unit);
    }
  }
  return "";
}

std::string describe_number(const Range& range) {
  std::string text = "a finite number";
  if (std::isfinite(range.lower)) {
    text += fmt::format(" {} {}", range.lower_open ? ">" : ">=", format_exact(range.lower));
  }
  if (std::isfinite(range.upper)) {
    text += fmt::format("{} <= {}", std::isfinite(range.lower) ? " and" : "",
                        format_exact(range.upper));
  }
  return text;
}

}  // namespace armwright
