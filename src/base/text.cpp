#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace armwright {
namespace {

// Allocates the whole table at once, because some files have tens of thousands of names to compare.
std::size_t calc_edit_distance(std::string_view a, std::string_view b) {
  const std::size_t row = b.size() + 1;
  std::vector<std::size_t> d((a.size() + 1) * row);
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      std::size_t& here = d[i * row + j];
      if (i == 0 || j == 0) {
        here = i + j;
        continue;
      }
      const std::size_t substitution = d[(i - 1) * row + j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      here = std::min({d[(i - 1) * row + j] + 1, d[i * row + j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        here = std::min(here, d[(i - 2) * row + j - 2] + 1);
      }
    }
  }
  return d.back();
}

// Returns the length of the valid UTF-8 sequence at the start of `text`, 0 if there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = byte(0) < 0x80                       ? 1
                             : byte(0) >= 0xC2 && byte(0) < 0xE0  ? 2
                             : byte(0) >= 0xE0 && byte(0) < 0xF0  ? 3
                             : byte(0) >= 0xF0 && byte(0) <= 0xF4 ? 4
                                                                  : 0;
  if (length == 0 || length > text.size()) {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) {
      return 0;
    }
  }
  const bool overlong = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
  const bool not_a_character =
      (byte(0) == 0xED && byte(1) >= 0xA0) || (byte(0) == 0xF4 && byte(1) >= 0x90);
  const bool c1_control = byte(0) == 0xC2 && byte(1) < 0xA0;
  return overlong || not_a_character || c1_control ? 0 : length;
}

// Returns whether the character changes the writing direction or separates lines: U+200E, U+200F,
// U+2028 to U+202E, U+2066 to U+2069. A name with such a character could look like another text on
// a terminal.
bool rearranges_text(std::string_view character) {
  if (character.size() != 3 || character[0] != '\xE2') {
    return false;
  }
  const auto second = static_cast<unsigned char>(character[1]);
  const auto third = static_cast<unsigned char>(character[2]);
  return (second == 0x80 && (third == 0x8E || third == 0x8F || (third >= 0xA8 && third <= 0xAE))) ||
         (second == 0x81 && third >= 0xA6 && third <= 0xA9);
}

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) {
    text.remove_prefix(1);  // from_chars() accepts no plus sign, but users write it
  }
  Number value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

std::optional<std::string> find_nearest(std::string_view name,
                                        std::span<const std::string> candidates) {
  // The cost of the distance grows with the product of the lengths, so longer names are not
  // compared.
  constexpr std::size_t kLongestName = 64;
  if (name.size() > kLongestName) {
    return std::nullopt;
  }
  std::optional<std::string> nearest;
  std::size_t best = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t length = std::max(name.size(), candidate.size());
    // At most a third of the letters may differ, or one of two letters. Names of one letter match
    // nothing else.
    const std::size_t near = length == 2 ? 1 : length / 3;
    if (length - std::min(name.size(), candidate.size()) > near) {
      continue;  // the lengths differ too much; this saves time for long lists from a file
    }
    const std::size_t distance = calc_edit_distance(name, candidate);
    if (distance <= near && (!nearest || distance < best)) {
      nearest = candidate;
      best = distance;
    }
  }
  return nearest;
}

std::string describe_unknown(std::string_view what, std::string_view name,
                             std::span<const std::string> valid) {
  // The valid names can come from the same file: there can be many, long and unprintable ones.
  constexpr std::size_t kMostListed = 200;
  const auto show = [](std::string_view text) {
    constexpr std::size_t kLongest_bytes = 100;
    return text.size() <= kLongest_bytes ? sanitize(text)
                                         : sanitize(text.substr(0, kLongest_bytes)) + "...";
  };
  const auto nearest = find_nearest(name, valid);
  std::vector<std::string> listed;
  for (const std::string& one : valid.first(std::min(valid.size(), kMostListed))) {
    listed.push_back(show(one));
  }
  if (valid.size() > kMostListed) {
    listed.push_back(fmt::format("and {} more", valid.size() - kMostListed));
  }
  return fmt::format("unknown {} '{}'{} Valid: {}", what, show(name),
                     nearest ? fmt::format("; did you mean '{}'?", show(*nearest)) : ".",
                     listed.empty() ? "(none)" : join(listed, ", "));
}

std::optional<double> parse_finite(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long long> parse_integer(std::string_view text) {
  return parse_whole<long long>(text);
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t at = text.find(separator);
    parts.emplace_back(text.substr(0, at));
    if (at == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(at + 1);
  }
}

std::string join(std::span<const std::string> parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

std::string format_exact(double value) {
  return fmt::format("{}", value);
}

std::string describe_number(double value, std::string_view unit, int digits) {
  if (std::isnan(value)) {
    return "not a number";
  }
  if (std::isinf(value)) {
    return value > 0 ? "infinite" : "minus infinite";
  }
  return fmt::format("{:.{}g}{}{}", value, digits, unit.empty() ? "" : " ", unit);
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) {
      return false;
    }
    text.remove_prefix(length);
  }
  return true;
}

std::string sanitize(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const bool printable =
        (length > 1 && !rearranges_text(text.substr(0, length))) ||
        (length == 1 && static_cast<unsigned char>(text[0]) >= 0x20 && text[0] != 0x7F);
    const std::size_t taken = std::max<std::size_t>(length, 1);
    clean += printable ? std::string(text.substr(0, taken)) : "?";
    text.remove_prefix(taken);
  }
  return clean;
}

bool begins_as_formula(std::string_view text) {
  return !text.empty() &&
         std::string_view("=+-@\t\r'").find(text.front()) != std::string_view::npos;
}

std::string quote_csv(std::string_view text) {
  const bool marked = begins_as_formula(text) && !parse_finite(text);
  const std::string harmless = (marked ? "'" : "") + std::string(text);
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    return harmless;
  }
  std::string quoted = "\"";
  for (const char c : harmless) {
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  }
  return quoted + '"';
}

std::string quote_command(std::span<const std::string> words) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  std::string command;
  for (const std::string& word : words) {
    command += command.empty() ? "" : " ";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      command += word;
      continue;
    }
    command += '\'';
    for (const char c : word) {
      command += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    command += '\'';
  }
  return command;
}

}  // namespace armwright
