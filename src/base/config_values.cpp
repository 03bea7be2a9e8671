// Values of a configuration as canonical JSON, and values made of settled numbers and texts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/config_tree.hpp"
#include "base/text.hpp"

namespace armwright::config {
namespace {

std::string quote_json(const std::string& text) {
  return nlohmann::json(text).dump();
}

// Appends the array `key`. `settled` holds what was settled in its elements, as "KEY[0]".
void append_array(const Value& array, std::string_view key, const Value& settled,
                  std::string& out) {
  out += '[';
  for (std::size_t i = 0; i < array.items.size(); ++i) {
    const auto found = settled.keys.find(fmt::format("{}[{}]", key, i));
    out += i == 0 ? "" : ",";
    append_json(array.items[i], found == settled.keys.end() ? nullptr : found->second.get(), out);
  }
  out += ']';
}

// Returns whether only keys that are left out stand in the file and in what was settled. Either may
// be null. An empty table in the file stays in the record.
bool is_left_out(const Value* own, const Value* settled) {
  if (settled == nullptr || settled->is_left_out) {
    return settled != nullptr;
  }
  if (settled->kind != Kind::table || settled->keys.empty() ||
      (own != nullptr && (own->kind != Kind::table || own->keys.empty()))) {
    return false;
  }
  const auto find_own = [&](const std::string& key) -> const Value* {
    return own != nullptr && own->keys.contains(key) ? own->keys.at(key).get() : nullptr;
  };
  return std::ranges::all_of(settled->keys,
                             [&](const auto& child) {
                               return is_left_out(find_own(child.first), child.second.get());
                             }) &&
         (own == nullptr || std::ranges::all_of(own->keys, [&](const auto& child) {
            return settled->keys.contains(child.first);
          }));
}

}  // namespace

void append_json(const Value& value, const Value* settled, std::string& out) {
  if (settled != nullptr && (settled->kind != Kind::table || value.kind != Kind::table)) {
    append_json(*settled, nullptr, out);
    return;
  }
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
        append_json(item, nullptr, out);
      }
      out += ']';
      return;
    case Kind::table: {
      std::map<std::string_view, std::pair<const Value*, const Value*>> both;
      for (const auto& [key, child] : value.keys) {
        if (!is_left_out(nullptr, child.get())) {
          both[key].first = child.get();
        }
      }
      if (settled != nullptr) {
        for (const auto& [key, child] : settled->keys) {
          if (key.ends_with(']')) {
            continue;  // of a table in an array
          }
          both[key].second = child.get();
        }
        std::erase_if(both, [](const auto& child) {
          return is_left_out(child.second.first, child.second.second);
        });
      }
      out += '{';
      for (const auto& [key, children] : both) {
        if (out.back() != '{') {
          out += ',';
        }
        out += quote_json(std::string(key)) + ':';
        const auto [own, chosen] = children;
        if (own != nullptr && own->kind == Kind::array && chosen == nullptr && settled != nullptr) {
          append_array(*own, key, *settled, out);
          continue;
        }
        append_json(own != nullptr ? *own : *chosen, own != nullptr ? chosen : nullptr, out);
      }
      out += '}';
      return;
    }
  }
}

Value make_settled(const std::string& text) {
  Value value;
  value.kind = Kind::string;
  value.string = text;
  return value;
}

Value make_settled(std::int64_t integer) {
  Value value;
  value.kind = Kind::integer;
  value.integer = integer;
  return value;
}

Value make_settled(int integer) {
  return make_settled(std::int64_t{integer});
}

Value make_settled(double number) {
  constexpr double kLongestWhole = 1e16;  // from here on a file would show an exponent
  if (number == std::trunc(number) && std::abs(number) < kLongestWhole) {
    return make_settled(static_cast<std::int64_t>(number));
  }
  Value value;
  value.kind = Kind::number;
  value.number = number;
  return value;
}

Value make_settled(bool boolean) {
  Value value;
  value.kind = Kind::boolean;
  value.boolean = boolean;
  return value;
}

Value make_settled(const std::vector<std::string>& texts) {
  Value value;
  value.kind = Kind::array;
  for (const std::string& text : texts) {
    value.items.push_back(make_settled(text));
  }
  return value;
}

Value make_settled(const std::vector<double>& numbers) {
  Value value;
  value.kind = Kind::array;
  for (const double number : numbers) {
    value.items.push_back(make_settled(number));
  }
  return value;
}

Value copy_value(const Value& value) {
  Value copy;
  copy.kind = value.kind;
  copy.string = value.string;
  copy.integer = value.integer;
  copy.number = value.number;
  copy.boolean = value.boolean;
  for (const Value& item : value.items) {
    copy.items.push_back(copy_value(item));
  }
  return copy;
}

}  // namespace armwright::config
