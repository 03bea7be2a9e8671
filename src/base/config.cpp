#include "base/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/config_tree.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {

using config::Kind;
using config::Value;

// A view of one table of the document, or of an empty table that stands for a missing one.
struct ConfigTable::Node {
  std::shared_ptr<const config::Document> document;
  std::shared_ptr<const Value> table;
  std::string path;
};

namespace {

using Node = ConfigTable::Node;

constexpr const char* kString = "a string";
constexpr const char* kBoolean = "true or false";

std::string describe_choice(std::span<const std::string> valid) {
  return fmt::format("one of these strings: {}", join(valid, ", "));
}

std::string describe_range(const Range& range) {
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

std::string describe_range(std::int64_t lower, std::int64_t upper) {
  const bool from = lower != std::numeric_limits<std::int64_t>::min();
  const bool to = upper != std::numeric_limits<std::int64_t>::max();
  if (from && to) {
    return fmt::format("an integer from {} to {}", lower, upper);
  }
  return from ? fmt::format("an integer >= {}", lower)
              : (to ? fmt::format("an integer <= {}", upper) : "an integer");
}

// The nearest of `names`, where a name may also have been given without its unit ("speed" for
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

// "requirement[3].use" -> "requirement[].use"
std::string drop_indices(const std::string& path) {
  std::string text;
  bool inside = false;
  for (const char c : path) {
    inside = inside && c != ']';
    if (!inside) {
      text += c;
    }
    inside = inside || c == '[';
  }
  return text;
}

// The first that says what is allowed counts.
void note_asked(const Node& node, std::string_view key, std::string_view allowed,
                std::string_view fallback = "") {
  const std::string path = drop_indices(config::join_path(node.path, key));
  AskedKey& asked = node.document->asked[path];
  asked.path = path;
  if (asked.allowed.empty()) {
    asked.allowed = allowed;
    asked.fallback = fallback;
  }
}

const Value* find(const Node& node, std::string_view key) {
  auto& asked = node.table->asked;
  if (std::find(asked.begin(), asked.end(), key) == asked.end()) {
    asked.emplace_back(key);
  }
  const auto found = node.table->keys.find(key);
  return found == node.table->keys.end() ? nullptr : found->second.get();
}

const Value& require(const Node& node, std::string_view key, std::string_view must) {
  note_asked(node, key, must);
  if (const Value* value = find(node, key)) {
    return *value;
  }
  std::vector<std::string>
      others;  // what was not asked for so far: perhaps one of them is this key, mistyped
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

double read_number(const Value& value, const std::string& path, const Range& range) {
  if (value.kind != Kind::number && value.kind != Kind::integer) {
    refuse_type(value, path, describe_range(range));
  }
  const double number =
      value.kind == Kind::number ? value.number : static_cast<double>(value.integer);
  const bool too_low = range.lower_open ? number <= range.lower : number < range.lower;
  if (too_low || number > range.upper) {
    config::fail(value.place, fmt::format("{} is {}; it must be {}", path, value.describe(),
                                          describe_range(range)));
  }
  return number;
}

struct Unknown {
  const Value* value;  // where it stands
  std::string path;
  std::string key;
  const Value* table;
};

std::string describe_unknown_key(const Unknown& unknown) {
  const std::vector<std::string>& asked = unknown.table->asked;
  const auto nearest = find_nearest_key(unknown.key, asked);
  return fmt::format(
      "{}: unknown key {}{} Valid here: {}", unknown.value->place.describe(),
      config::join_path(unknown.path, unknown.key),
      nearest ? fmt::format("; did you mean '{}'?", config::join_path(unknown.path, *nearest))
              : ".",
      asked.empty() ? "(none)" : join(asked, ", "));
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

std::string quote_json(const std::string& text) {
  return nlohmann::json(text).dump();
}

void append_json(const Value& value, std::string& out) {
  switch (value.kind) {
    case Kind::string:
    case Kind::date:
      out += quote_json(value.string);
      return;
    case Kind::integer:
      out += fmt::format("{}", value.integer);
      return;
    case Kind::number: {
      const std::string digits = format_exact(value.number);
      // 2.0 must not turn into the integer 2
      out += digits + (digits.find_first_of(".e") == std::string::npos ? ".0" : "");
      return;
    }
    case Kind::boolean:
      out += value.boolean ? "true" : "false";
      return;
    case Kind::array:
      out += '[';
      for (const Value& item : value.items) {
        if (&item != value.items.data()) {
          out += ',';
        }
        append_json(item, out);
      }
      out += ']';
      return;
    case Kind::table:
      out += '{';
      for (const auto& [key, child] : value.keys) {
        if (out.back() != '{') {
          out += ',';
        }
        out += quote_json(key) + ':';
        append_json(*child, out);
      }
      out += '}';
      return;
  }
}

std::shared_ptr<Node> make_root(std::shared_ptr<const config::Document> document) {
  const std::shared_ptr<const Value> root(document, &document->root);
  return std::make_shared<Node>(Node{std::move(document), root, ""});
}

std::shared_ptr<Node> make_child(const Node& parent, const Value& table, std::string path) {
  return std::make_shared<Node>(Node{
      parent.document, std::shared_ptr<const Value>(parent.document, &table), std::move(path)});
}

}  // namespace

ConfigTable::ConfigTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}

ConfigTable ConfigTable::load(const std::filesystem::path& file,
                              std::span<const std::string> overrides,
                              const std::filesystem::path& shipped) {
  return ConfigTable(make_root(config::load_document(file, overrides, shipped)));
}

ConfigTable ConfigTable::parse(std::string_view toml, const std::string& name,
                               std::span<const std::string> overrides) {
  return ConfigTable(make_root(config::parse_document(toml, name, overrides)));
}

bool ConfigTable::has(std::string_view key) const {
  note_asked(*node_, key, "");
  return find(*node_, key) != nullptr;
}

std::string ConfigTable::get_string(std::string_view key) const {
  return require_kind(*node_, key, Kind::string, kString).string;
}

std::string ConfigTable::get_choice(std::string_view key,
                                    std::span<const std::string> valid) const {
  const Value& value = require_kind(*node_, key, Kind::string, describe_choice(valid));
  if (std::find(valid.begin(), valid.end(), value.string) == valid.end()) {
    config::fail(value.place, describe_unknown(config::join_path(node_->path, key),
                                               config::shorten(value.string), valid));
  }
  return value.string;
}

double ConfigTable::get_number(std::string_view key, Range range) const {
  return read_number(require(*node_, key, describe_range(range)),
                     config::join_path(node_->path, key), range);
}

std::int64_t ConfigTable::get_integer(std::string_view key, std::int64_t lower,
                                      std::int64_t upper) const {
  const std::string must = describe_range(lower, upper);
  const Value& value = require_kind(*node_, key, Kind::integer, must);
  if (value.integer < lower || value.integer > upper) {
    config::fail(value.place,
                 fmt::format("{} is {}; it must be {}", config::join_path(node_->path, key),
                             value.describe(), must));
  }
  return value.integer;
}

bool ConfigTable::get_bool(std::string_view key) const {
  return require_kind(*node_, key, Kind::boolean, kBoolean).boolean;
}

std::vector<double> ConfigTable::get_numbers(std::string_view key, Range range) const {
  const Value& array =
      require_kind(*node_, key, Kind::array,
                   fmt::format("an array, each element of it {}", describe_range(range)));
  const std::string path = config::join_path(node_->path, key);
  std::vector<double> numbers;
  for (const Value& item : array.items) {
    numbers.push_back(read_number(item, fmt::format("{}[{}]", path, numbers.size()), range));
  }
  return numbers;
}

std::vector<std::string> ConfigTable::get_strings(std::string_view key) const {
  const Value& array = require_kind(*node_, key, Kind::array, "an array of strings");
  std::vector<std::string> strings;
  for (const Value& item : array.items) {
    if (item.kind != Kind::string) {
      refuse_type(item, fmt::format("{}[{}]", config::join_path(node_->path, key), strings.size()),
                  "a string");
    }
    strings.push_back(item.string);
  }
  return strings;
}

ConfigTable ConfigTable::get_table(std::string_view key) const {
  const std::string path = config::join_path(node_->path, key);
  const Value& table = require_kind(*node_, key, Kind::table, fmt::format("a table, [{}]", path));
  return ConfigTable(make_child(*node_, table, path));
}

std::vector<ConfigTable> ConfigTable::get_tables(std::string_view key) const {
  const std::string path = config::join_path(node_->path, key);
  const std::string must = fmt::format("an array of tables, [[{}]]", path);
  const Value& array = require_kind(*node_, key, Kind::array, must);
  std::vector<ConfigTable> tables;
  for (const Value& item : array.items) {
    const std::string item_path = fmt::format("{}[{}]", path, tables.size());
    if (item.kind != Kind::table) {
      refuse_type(item, item_path, "a table");
    }
    tables.push_back(ConfigTable(make_child(*node_, item, item_path)));
  }
  return tables;
}

std::string ConfigTable::get_string(std::string_view key, std::string_view fallback) const {
  note_asked(*node_, key, kString, quote_json(std::string(fallback)));
  return has(key) ? get_string(key) : std::string(fallback);
}

std::string ConfigTable::get_choice(std::string_view key, std::span<const std::string> valid,
                                    std::string_view fallback) const {
  note_asked(*node_, key, describe_choice(valid), quote_json(std::string(fallback)));
  return has(key) ? get_choice(key, valid) : std::string(fallback);
}

double ConfigTable::get_number_or(std::string_view key, double fallback, Range range) const {
  note_asked(*node_, key, describe_range(range), format_exact(fallback));
  return has(key) ? get_number(key, range) : fallback;
}

std::int64_t ConfigTable::get_integer_or(std::string_view key, std::int64_t fallback,
                                         std::int64_t lower, std::int64_t upper) const {
  note_asked(*node_, key, describe_range(lower, upper), fmt::format("{}", fallback));
  return has(key) ? get_integer(key, lower, upper) : fallback;
}

bool ConfigTable::get_bool_or(std::string_view key, bool fallback) const {
  note_asked(*node_, key, kBoolean, fallback ? "true" : "false");
  return has(key) ? get_bool(key) : fallback;
}

ConfigTable ConfigTable::get_table_or_empty(std::string_view key) const {
  if (has(key)) {
    return get_table(key);
  }
  const auto empty = std::make_shared<Value>();
  empty->place = node_->table->place;
  return ConfigTable(
      std::make_shared<Node>(Node{node_->document, empty, config::join_path(node_->path, key)}));
}

std::vector<ConfigTable> ConfigTable::get_tables_or_empty(std::string_view key) const {
  return has(key) ? get_tables(key) : std::vector<ConfigTable>();
}

void ConfigTable::refuse_unknown() const {
  constexpr std::size_t kShown = 8;  // enough to mend a file in one go, too few to flood a terminal
  std::vector<Unknown> unknown;
  collect_unknown(*node_->table, node_->path, unknown);
  if (unknown.empty()) {
    return;
  }
  std::stable_sort(unknown.begin(), unknown.end(), [](const Unknown& a, const Unknown& b) {
    return a.value->place.line < b.value->place.line;
  });
  std::string message;
  for (std::size_t i = 0; i < std::min(unknown.size(), kShown); ++i) {
    message += (i == 0 ? "" : "\n") + describe_unknown_key(unknown[i]);
  }
  if (unknown.size() > kShown) {
    message += fmt::format("\nand {} more unknown keys", unknown.size() - kShown);
  }
  throw Error(ErrorKind::usage, message);
}

void ConfigTable::refuse(std::string_view key, std::string_view must) const {
  const std::string path = config::join_path(node_->path, key);
  if (const Value* value = find(*node_, key)) {
    config::fail(value->place, fmt::format("{} is {}; {}", path, value->describe(), must));
  }
  config::fail(node_->table->place, fmt::format("{} is missing; {}", path, must));
}

std::vector<AskedKey> ConfigTable::asked() const {
  std::vector<AskedKey> all;
  for (const auto& [path, key] : node_->document->asked) {
    all.push_back(key);
  }
  return all;
}

const std::filesystem::path& ConfigTable::file() const {
  return node_->document->file;
}

std::vector<std::filesystem::path> ConfigTable::files() const {
  return node_->document->files;
}

std::string ConfigTable::to_json() const {
  std::string json;
  append_json(*node_->table, json);
  return json;
}

}  // namespace armwright
