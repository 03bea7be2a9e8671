// Reads the fields of a plugin's messages and refuses wrong ones.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/text.hpp"
#include "optimizers/plugins/plugin_messages.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kQuoted = 80;  // characters of a bad line that are shown

bool is_name(const std::string& text) {
  constexpr std::size_t kLongestName = 64;
  return !text.empty() && text.size() <= kLongestName &&
         std::isalnum(static_cast<unsigned char>(text[0])) != 0 &&
         std::ranges::all_of(text, [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ||
                  c == '.';
         });
}

}  // namespace

std::string quote(const std::string& text) {
  return fmt::format("'{}'{}", sanitize(text.substr(0, kQuoted)),
                     text.size() > kQuoted ? "..." : "");
}

std::string quote(const json& value) {
  return quote(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

const json& require(const json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) {
    throw ProtocolError(fmt::format("sent {} without \"{}\"", where, key));
  }
  return *found;
}

std::string read_text(const json& object, const char* key, const std::string& where) {
  const json& value = require(object, key, where);
  if (!value.is_string()) {
    throw ProtocolError(
        fmt::format("sent {} whose \"{}\" is {}, not a text", where, key, quote(value)));
  }
  return sanitize(value.get<std::string>());
}

std::string read_name(const json& object, const std::string& where) {
  const std::string name = read_text(object, "name", where);
  if (!is_name(name)) {
    throw ProtocolError(
        fmt::format("sent {} named {}; a name begins with a letter or digit, goes on with letters, "
                    "digits, '_', '-' and '.', and has at most 64 of them",
                    where, quote(name)));
  }
  return name;
}

// A number counts as a number with or without a decimal point.
double read_number(const json& object, const char* key, const std::string& where) {
  const json& value = require(object, key, where);
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    throw ProtocolError(
        fmt::format("sent {} whose \"{}\" is {}, not a number", where, key, quote(value)));
  }
  return value.get<double>();
}

}  // namespace armwright
