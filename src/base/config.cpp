#include "base/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/config_tree.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {

using config::append_json;
using config::copy_value;
using config::Kind;
using config::make_settled;
using config::Value;

// One table of the document, or an empty table in place of a missing one.
struct ConfigTable::Node {
  std::shared_ptr<const config::Document> document;
  std::shared_ptr<const Value> table;
  std::string path;
  const SettingTable* declared;  // what may be read; null: any setting
  const SettingTable* file;      // the same of the whole document
};

namespace {

using Node = ConfigTable::Node;

constexpr const char* kString = "a string";

void check_declared(const Node& node, const AnySetting& setting) {
  const auto has_key = [&](const AnySetting* one) { return one->key == setting.key; };
  if (node.declared != nullptr && std::ranges::none_of(node.declared->settings, has_key)) {
    throw std::logic_error(fmt::format("setting '{}' is read in table '{}', which does not list it",
                                       setting.key, node.path));
  }
}

// Returns what may be read in the inner table.
const SettingTable* check_declared(const Node& node, const SettingTable& inner) {
  if (node.declared == nullptr) {
    return nullptr;
  }
  if (std::ranges::find(node.declared->tables, &inner) == node.declared->tables.end()) {
    throw std::logic_error(fmt::format("table '{}' is read in table '{}', which does not list it",
                                       inner.key, node.path));
  }
  return &inner;
}

// Returns the nearest of `names`. The key may lack the unit that a name ends with ("speed" for
// "speed_m_per_s").
std::optional<std::string> find_nearest_key(std::string_view key,
                                            const std::vector<std::string>& names) {
  if (const auto nearest = find_nearest(key, names)) {
    return nearest;
  }
  std::vector<std::string> stems;
  std::vector<std::string> owners;
  for (const std::string& name : names) {
    for (std::size_t at = name.find('_'); at != std::string::npos; at = name.find('_', at + 1)) {
      stems.push_back(name.substr(0, at));
      owners.push_back(name);
    }
  }
  const auto stem = find_nearest(key, stems);
  return stem ? std::optional(owners[std::find(stems.begin(), stems.end(), *stem) - stems.begin()])
              : std::nullopt;
}

// Returns the value of the key, or null. The key counts as read from now on.
const Value* find_value(const Node& node, std::string_view key) {
  auto& asked = node.table->asked;
  if (std::find(asked.begin(), asked.end(), key) == asked.end()) {
    asked.emplace_back(key);
  }
  const auto found = node.table->keys.find(key);
  return found == node.table->keys.end() ? nullptr : found->second.get();
}

const Value& require(const Node& node, std::string_view key, std::string_view must) {
  if (const Value* value = find_value(node, key)) {
    return *value;
  }
  // One of the keys that nobody has read so far may be this key, mistyped.
  std::vector<std::string> others;
  for (const auto& [other, value] : node.table->keys) {
    if (std::find(node.table->asked.begin(), node.table->asked.end(), other) ==
        node.table->asked.end()) {
      others.push_back(other);
    }
  }
  std::string hint;
  for (const std::string& other : others) {
    const std::vector<std::string> wanted = {std::string(key)};
    if (find_nearest_key(other, wanted)) {
      hint = fmt::format(" (is {} in {} meant?)", config::join_path(node.path, other),
                         node.table->keys.at(other)->place.describe());
      break;
    }
  }
  config::fail(node.table->place, fmt::format("{} is missing; it must be {}{}",
                                              config::join_path(node.path, key), must, hint));
}

[[noreturn]] void refuse_type(const Value& value, const std::string& path, std::string_view must) {
  config::fail(value.place,
               fmt::format("{} is {}; it must be {}", path, value.describe_with_type(), must));
}

const Value& require_kind(const Node& node, std::string_view key, Kind kind,
                          std::string_view must) {
  const Value& value = require(node, key, must);
  if (value.kind != kind) {
    refuse_type(value, config::join_path(node.path, key), must);
  }
  return value;
}

double read_number(const Value& value, const std::string& path, const AnySetting& setting) {
  const Range& range = setting.range;
  if (value.kind != Kind::number && value.kind != Kind::integer) {
    refuse_type(value, path, describe_number(range));
  }
  const double number =
      value.kind == Kind::number ? value.number : static_cast<double>(value.integer);
  if (!range.contains(number)) {
    constexpr double kMillimetres = 1000;  // per metre
    constexpr double kFarBeyond = 3;       // a smaller excess is in metres
    const double exceeded = number > range.upper ? range.upper : range.lower;
    const bool may_be_millimetres = (setting.unit == "m" || setting.unit.starts_with("m/")) &&
                                    std::abs(number) > kFarBeyond * std::abs(exceeded) &&
                                    range.contains(number / kMillimetres);
    config::fail(
        value.place,
        fmt::format(
            "{} is {}; it must be {}{}", path, value.describe(), describe_number(range),
            may_be_millimetres
                ? fmt::format("; {} {}: were millimetres meant? Then write {}", value.describe(),
                              setting.unit, format_exact(number / kMillimetres))
                : ""));
  }
  return number;
}

// A key that no reader read.
struct Unknown {
  const Value* value;
  std::string path;
  std::string key;
  const Value* table;  // that holds the key
};

std::string describe_unknown_key(const Unknown& unknown, std::string_view list_command) {
  const std::vector<std::string>& asked = unknown.table->asked;
  const auto nearest = find_nearest_key(unknown.key, asked);
  return fmt::format(
      "{}: unknown key {}{} Valid here: {}", unknown.value->place.describe(),
      config::join_path(unknown.path, unknown.key),
      nearest ? fmt::format("; did you mean '{}'?", config::join_path(unknown.path, *nearest))
              : ".",
      list_valid(nearest.value_or(unknown.key), asked, list_command));
}

void collect_unknown(const Value& value, const std::string& path, std::vector<Unknown>& unknown) {
  for (std::size_t i = 0; i < value.items.size(); ++i) {
    if (value.items[i].kind == Kind::table) {
      collect_unknown(value.items[i], fmt::format("{}[{}]", path, i), unknown);
    }
  }
  for (const auto& [key, child] : value.keys) {
    const std::string child_path = config::join_path(path, key);
    if (std::find(value.asked.begin(), value.asked.end(), key) != value.asked.end()) {
      collect_unknown(*child, child_path, unknown);
      continue;
    }
    unknown.push_back({child.get(), path, key, &value});
  }
}

void settle_value(const Node& node, const std::string& key, Value value) {
  Value* table = &node.document->settled;
  for (const std::string& step : split(node.path, '.')) {
    if (!step.empty()) {  // the path of the whole document is empty
      auto& slot = table->keys[step];
      slot = slot ? std::move(slot) : std::make_unique<Value>();
      table = slot.get();
    }
  }
  table->keys[key] = std::make_unique<Value>(std::move(value));
}

// Returns the settled values of this table, or null.
const Value* find_settled(const Node& node) {
  const Value* table = &node.document->settled;
  for (const std::string& step : split(node.path, '.')) {
    if (!step.empty()) {
      const auto found = table->keys.find(step);
      if (found == table->keys.end()) {
        return nullptr;
      }
      table = found->second.get();
    }
  }
  return table;
}

std::shared_ptr<Node> make_root(std::shared_ptr<const config::Document> document,
                                const SettingTable* declared) {
  const std::shared_ptr<const Value> root(document, &document->root);
  return std::make_shared<Node>(Node{std::move(document), root, "", declared, declared});
}

std::shared_ptr<Node> make_child(const Node& parent, const Value& table, std::string path,
                                 const SettingTable* declared) {
  return std::make_shared<Node>(Node{parent.document,
                                     std::shared_ptr<const Value>(parent.document, &table),
                                     std::move(path), declared, parent.file});
}

// The overloads of read() return the value of a key that must be there.

double read(const Node& node, const Setting<double>& setting) {
  return read_number(require(node, setting.key, setting.describe_allowed()),
                     config::join_path(node.path, setting.key), setting);
}

// Returns the integer that a value stands for. TOML has no integers of the forms that parse_count()
// reads: 1e3 is a floating-point number there, and 10k and 2M are strings.
std::optional<std::int64_t> find_integer(const Value& value) {
  if (value.kind == Kind::integer) {
    return value.integer;
  }
  if (value.kind == Kind::number) {
    return parse_count(value.written);
  }
  const bool has_unit = value.string.ends_with('k') || value.string.ends_with('M');
  return value.kind == Kind::string && has_unit ? parse_count(value.string) : std::nullopt;
}

std::int64_t read_integer(const Node& node, const AnySetting& setting) {
  const std::string must = setting.describe_allowed();
  const Value& value = require(node, setting.key, must);
  const auto integer = find_integer(value);
  if (!integer) {
    refuse_type(value, config::join_path(node.path, setting.key), must);
  }
  if (!setting.range.contains(static_cast<double>(*integer))) {
    config::fail(value.place,
                 fmt::format("{} is {}; it must be {}", config::join_path(node.path, setting.key),
                             value.describe(), must));
  }
  if (value.kind != Kind::integer) {
    settle_value(node, setting.key, make_settled(*integer));  // the record has 1000 for 1e3
  }
  return *integer;
}

std::int64_t read(const Node& node, const Setting<std::int64_t>& setting) {
  return read_integer(node, setting);
}

int read(const Node& node, const Setting<int>& setting) {
  return static_cast<int>(read_integer(node, setting));
}

bool read(const Node& node, const Setting<bool>& setting) {
  return require_kind(node, setting.key, Kind::boolean, setting.describe_allowed()).boolean;
}

// Returns the command that lists the valid texts of a setting. Empty if they are not the declared
// ones, but depend on the document.
std::string name_list_command(const Node& node, const AnySetting& setting,
                              const std::vector<std::string>& valid) {
  if (node.file == nullptr || !node.file->listed_as) {
    return "";
  }
  const auto declared = std::ranges::find(node.declared->settings, setting.key, &AnySetting::key);
  if (!(*declared)->choices || (*declared)->choices() != valid) {
    return "";
  }
  std::string path = config::join_path(node.path, setting.key);
  for (std::size_t at = path.find('['); at != std::string::npos; at = path.find('[', at + 1)) {
    path.erase(at + 1, path.find(']', at) - at - 1);  // requirement[0].quantity
  }
  return fmt::format("armwright list settings {}{}", *node.file->listed_as, path);
}

std::string read(const Node& node, const Setting<std::string>& setting) {
  const Value& value = require_kind(node, setting.key, Kind::string, setting.describe_allowed());
  if (setting.choices) {
    const std::vector<std::string> valid = setting.choices();
    if (std::ranges::find(valid, value.string) == valid.end()) {
      config::fail(value.place, describe_unknown(config::join_path(node.path, setting.key),
                                                 config::shorten(value.string), valid,
                                                 name_list_command(node, setting, valid)));
    }
  }
  return value.string;
}

std::vector<double> read(const Node& node, const Setting<std::vector<double>>& setting) {
  const Value& array = require_kind(node, setting.key, Kind::array, setting.describe_allowed());
  const std::string path = config::join_path(node.path, setting.key);
  std::vector<double> numbers;
  for (const Value& item : array.items) {
    numbers.push_back(read_number(item, fmt::format("{}[{}]", path, numbers.size()), setting));
  }
  return numbers;
}

std::vector<std::string> read(const Node& node, const Setting<std::vector<std::string>>& setting) {
  const Value& array = require_kind(node, setting.key, Kind::array, setting.describe_allowed());
  const std::string path = config::join_path(node.path, setting.key);
  std::vector<std::string> strings;
  for (const Value& item : array.items) {
    if (item.kind != Kind::string) {
      refuse_type(item, fmt::format("{}[{}]", path, strings.size()), kString);
    }
    strings.push_back(item.string);
  }
  return strings;
}

}  // namespace

ConfigTable::ConfigTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}

ConfigTable ConfigTable::load(const SettingTable& settings, const std::filesystem::path& file,
                              std::span<const std::string> overrides,
                              const std::filesystem::path& shipped) {
  return ConfigTable(make_root(config::load_document(file, overrides, shipped), &settings));
}

ConfigTable ConfigTable::parse(const SettingTable& settings, std::string_view toml,
                               const std::string& name, std::span<const std::string> overrides) {
  return ConfigTable(make_root(config::parse_document(toml, name, overrides), &settings));
}

ConfigTable ConfigTable::load(const std::filesystem::path& file,
                              std::span<const std::string> overrides,
                              const std::filesystem::path& shipped) {
  return ConfigTable(make_root(config::load_document(file, overrides, shipped), nullptr));
}

ConfigTable ConfigTable::parse(std::string_view toml, const std::string& name,
                               std::span<const std::string> overrides) {
  return ConfigTable(make_root(config::parse_document(toml, name, overrides), nullptr));
}

bool ConfigTable::has(const AnySetting& setting) const {
  check_declared(*node_, setting);
  return has(setting.key);
}

bool ConfigTable::has(std::string_view key) const {
  return find_value(*node_, key) != nullptr;
}

template <class T>
std::optional<T> ConfigTable::find(const Setting<T>& setting) const {
  return has(setting) ? std::optional(read(*node_, setting)) : std::nullopt;
}

template <class T>
T ConfigTable::get_or(const Setting<T>& setting, const std::type_identity_t<T>& fallback) const {
  return has(setting) ? read(*node_, setting) : fallback;
}

template <class T>
T ConfigTable::get(const Setting<T>& setting) const {
  check_declared(*node_, setting);
  return setting.fallback ? get_or(setting, *setting.fallback) : read(*node_, setting);
}

std::size_t ConfigTable::get_choice(const Setting<std::string>& setting) const {
  const std::vector<std::string> choices = setting.choices();
  return static_cast<std::size_t>(std::ranges::find(choices, get(setting)) - choices.begin());
}

template <class T>
void ConfigTable::settle(const Setting<T>& setting, const std::type_identity_t<T>& value) const {
  check_declared(*node_, setting);
  settle_value(*node_, setting.key, make_settled(value));
}

void ConfigTable::leave_out(const AnySetting& setting) const {
  check_declared(*node_, setting);
  Value left_out;
  left_out.is_left_out = true;
  settle_value(*node_, setting.key, std::move(left_out));
}

void ConfigTable::settle_missing(const ConfigTable& other) const {
  for (const auto& [key, value] : other.node_->table->keys) {
    if (!has(key)) {
      settle_value(*node_, key, copy_value(*value));
    }
  }
}

template bool ConfigTable::get(const Setting<bool>&) const;
template int ConfigTable::get(const Setting<int>&) const;
template std::int64_t ConfigTable::get(const Setting<std::int64_t>&) const;
template double ConfigTable::get(const Setting<double>&) const;
template std::string ConfigTable::get(const Setting<std::string>&) const;
template std::vector<double> ConfigTable::get(const Setting<std::vector<double>>&) const;
template std::vector<std::string> ConfigTable::get(const Setting<std::vector<std::string>>&) const;
template bool ConfigTable::get_or(const Setting<bool>&, const bool&) const;
template int ConfigTable::get_or(const Setting<int>&, const int&) const;
template std::int64_t ConfigTable::get_or(const Setting<std::int64_t>&, const std::int64_t&) const;
template double ConfigTable::get_or(const Setting<double>&, const double&) const;
template std::string ConfigTable::get_or(const Setting<std::string>&, const std::string&) const;
template std::vector<double> ConfigTable::get_or(const Setting<std::vector<double>>&,
                                                 const std::vector<double>&) const;
template std::vector<std::string> ConfigTable::get_or(const Setting<std::vector<std::string>>&,
                                                      const std::vector<std::string>&) const;
template std::optional<bool> ConfigTable::find(const Setting<bool>&) const;
template std::optional<int> ConfigTable::find(const Setting<int>&) const;
template std::optional<std::int64_t> ConfigTable::find(const Setting<std::int64_t>&) const;
template std::optional<double> ConfigTable::find(const Setting<double>&) const;
template std::optional<std::string> ConfigTable::find(const Setting<std::string>&) const;
template std::optional<std::vector<double>> ConfigTable::find(
    const Setting<std::vector<double>>&) const;
template std::optional<std::vector<std::string>> ConfigTable::find(
    const Setting<std::vector<std::string>>&) const;
template void ConfigTable::settle(const Setting<int>&, const int&) const;
template void ConfigTable::settle(const Setting<std::int64_t>&, const std::int64_t&) const;
template void ConfigTable::settle(const Setting<double>&, const double&) const;
template void ConfigTable::settle(const Setting<std::string>&, const std::string&) const;
template void ConfigTable::settle(const Setting<bool>&, const bool&) const;
template void ConfigTable::settle(const Setting<std::vector<double>>&,
                                  const std::vector<double>&) const;
template void ConfigTable::settle(const Setting<std::vector<std::string>>&,
                                  const std::vector<std::string>&) const;

ConfigTable ConfigTable::get_table(const SettingTable& table) const {
  const SettingTable* declared = check_declared(*node_, table);
  const std::string path = config::join_path(node_->path, table.key);
  const Value& value =
      require_kind(*node_, table.key, Kind::table, fmt::format("a table, [{}]", path));
  return ConfigTable(make_child(*node_, value, path, declared));
}

std::vector<ConfigTable> ConfigTable::get_tables(const SettingTable& array) const {
  const SettingTable* declared = check_declared(*node_, array);
  const std::string path = config::join_path(node_->path, array.key);
  const Value& value =
      require_kind(*node_, array.key, Kind::array, fmt::format("an array of tables, [[{}]]", path));
  std::vector<ConfigTable> tables;
  for (const Value& item : value.items) {
    const std::string item_path = fmt::format("{}[{}]", path, tables.size());
    if (item.kind != Kind::table) {
      refuse_type(item, item_path, "a table");
    }
    tables.push_back(ConfigTable(make_child(*node_, item, item_path, declared)));
  }
  return tables;
}

ConfigTable ConfigTable::get_table_or_empty(const SettingTable& table) const {
  if (has(table.key)) {
    return get_table(table);
  }
  const auto empty = std::make_shared<Value>();
  empty->place = node_->table->place;
  return ConfigTable(
      std::make_shared<Node>(Node{node_->document, empty, config::join_path(node_->path, table.key),
                                  check_declared(*node_, table), node_->file}));
}

std::vector<ConfigTable> ConfigTable::get_tables_or_empty(const SettingTable& array) const {
  check_declared(*node_, array);
  return has(array.key) ? get_tables(array) : std::vector<ConfigTable>();
}

void ConfigTable::refuse_unknown() const {
  constexpr std::size_t kShown = 8;  // enough to mend a file at once, too few to flood a terminal
  std::vector<Unknown> unknown;
  collect_unknown(*node_->table, node_->path, unknown);
  if (unknown.empty()) {
    return;
  }
  std::stable_sort(unknown.begin(), unknown.end(), [](const Unknown& a, const Unknown& b) {
    return a.value->place.line < b.value->place.line;
  });
  const std::string list_command =
      node_->file != nullptr && node_->file->listed_as ? "armwright list settings" : "";
  std::string message;
  for (std::size_t i = 0; i < std::min(unknown.size(), kShown); ++i) {
    message += (i == 0 ? "" : "\n") + describe_unknown_key(unknown[i], list_command);
  }
  if (unknown.size() > kShown) {
    message += fmt::format("\nand {} more unknown keys", unknown.size() - kShown);
  }
  throw Error(ErrorKind::usage, message);
}

void ConfigTable::refuse(std::string_view key, std::string_view must) const {
  const std::string path = config::join_path(node_->path, key);
  if (const Value* value = find_value(*node_, key)) {
    config::fail(value->place, fmt::format("{} is {}; {}", path, value->describe(), must));
  }
  config::fail(node_->table->place, fmt::format("{} is missing; {}", path, must));
}

void ConfigTable::refuse(const AnySetting& setting, std::string_view must) const {
  refuse(setting.key, must);
}

std::string ConfigTable::describe_place(const AnySetting& setting,
                                        std::optional<std::size_t> element) const {
  const Value* value = find_value(*node_, setting.key);
  assert(value != nullptr);
  const std::string path = config::join_path(node_->path, setting.key);
  return element
             ? fmt::format("{}: {}[{}]", value->items.at(*element).place.describe(), path, *element)
             : fmt::format("{}: {}", value->place.describe(), path);
}

const std::filesystem::path& ConfigTable::file() const {
  return node_->document->file;
}

std::vector<std::filesystem::path> ConfigTable::files() const {
  return node_->document->files;
}

std::string ConfigTable::to_json() const {
  std::string json;
  append_json(*node_->table, find_settled(*node_), json);
  return json;
}

}  // namespace armwright
