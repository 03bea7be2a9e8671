#include "process/json_message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include "base/text.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kQuoted = 80;  // characters of a bad line that are shown

// Writing, comparing and copying JSON recurse once per level. No message of a protocol needs so
// many levels.
constexpr int kDeepest = 16;

bool has_nan_token(const std::string& line) {
  return line.find("NaN") != std::string::npos || line.find("Infinity") != std::string::npos;
}

// Returns the line with null in place of NaN, Infinity and -Infinity outside of texts.
std::string replace_nan(const std::string& line) {
  constexpr std::array<std::string_view, 3> kTokens = {"NaN", "-Infinity", "Infinity"};
  std::string replaced;
  bool in_text = false;
  for (std::size_t i = 0; i < line.size();) {
    const std::string_view rest = std::string_view(line).substr(i);
    const auto token =
        std::ranges::find_if(kTokens, [&](std::string_view one) { return rest.starts_with(one); });
    if (!in_text && token != kTokens.end()) {
      replaced += "null";
      i += token->size();
      continue;
    }
    const std::size_t count = in_text && line[i] == '\\' && rest.size() > 1 ? 2 : 1;
    in_text ^= line[i] == '"';
    replaced += rest.substr(0, count);
    i += count;
  }
  return replaced;
}

}  // namespace

bool is_name(const std::string& text) {
  constexpr std::size_t kLongestName = 64;
  return !text.empty() && text.size() <= kLongestName &&
         std::isalnum(static_cast<unsigned char>(text[0])) != 0 &&
         std::ranges::all_of(text, [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ||
                  c == '.';
         });
}

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
    throw ProtocolError(fmt::format("sent {} named {}; {}", where, quote(name), kNameRule));
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

json read_message(const std::string& line, bool allows_nan) {
  const auto refuse_depth = [&](int depth, json::parse_event_t event, const json&) {
    const bool begins_level =
        event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (begins_level && depth >= kDeepest) {
      throw ProtocolError(
          fmt::format("sent JSON nested more than {} deep: {}", kDeepest, quote(line)));
    }
    return true;
  };
  json message;
  try {
    message = json::parse(line, refuse_depth);
  } catch (const json::exception&) {
    if (allows_nan && has_nan_token(line)) {
      return read_message(replace_nan(line));
    }
    throw ProtocolError(fmt::format(
        "sent a line that is not JSON: {}{}", quote(line),
        has_nan_token(line)
            ? " (JSON knows no NaN and no Infinity; points must be finite)"
            : " (its standard output is for the protocol; notes belong on standard error)"));
  }
  if (!message.is_object() || !message.contains("type") || !message["type"].is_string()) {
    throw ProtocolError(
        fmt::format("sent JSON that is no object with a \"type\": {}", quote(line)));
  }
  return message;
}

std::string read_type(const json& message) {
  return message.at("type").get<std::string>();
}

}  // namespace armwright
