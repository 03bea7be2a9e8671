#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <compare>
#include <cstdint>
#include <iterator>

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

// Returns the name without the differences that find_nearest() ignores.
std::string fold_name(std::string_view name) {
  std::string folded;
  for (const char c : name) {
    if (std::string_view("-_: ").find(c) == std::string_view::npos) {
      folded += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  return folded;
}

// How near a candidate is to a name: near ones come first, then the smaller distance of the folded
// names, then the smaller distance of the names as they are written, then the earlier candidate.
struct RankedName {
  bool is_far = true;
  std::size_t folded_distance = 0;
  std::size_t written_distance = 0;
  std::size_t index = 0;

  auto operator<=>(const RankedName&) const = default;
};

// Compares two folded names.
RankedName compare_folded(std::string_view name, std::string_view candidate) {
  const std::size_t length = std::max(name.size(), candidate.size());
  const std::size_t difference = length - std::min(name.size(), candidate.size());
  // At most a third of the letters may differ, or one of two letters. Names of one letter match
  // nothing else.
  const std::size_t near = length == 2 ? 1 : length / 3;
  RankedName ranked;
  if (difference > near) {
    // The distance is at least the difference. Its computation would take long for long lists from
    // a file, so a candidate that does not contain the name counts as if no letter agreed.
    const bool contains = candidate.find(name) != std::string_view::npos;
    ranked.folded_distance = contains ? difference : length;
    return ranked;
  }
  ranked.folded_distance = calc_edit_distance(name, candidate);
  ranked.is_far = ranked.folded_distance > near;
  return ranked;
}

// Returns the `most` candidates that are nearest to the name, the nearest first. Of a name without
// letters, and of a longer name than 64 bytes, returns the first candidates as far ones: the cost of
// a distance grows with the product of the lengths.
std::vector<RankedName> rank_names(std::string_view name, std::span<const std::string> candidates,
                                   std::size_t most) {
  constexpr std::size_t kLongestName = 64;
  const std::string folded = fold_name(name);
  const bool is_compared = !folded.empty() && name.size() <= kLongestName;
  std::vector<RankedName> ranked;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    RankedName one;
    if (is_compared) {
      const std::string_view candidate = candidates[i];
      one = compare_folded(folded, fold_name(candidate));
      const std::size_t colon = candidate.rfind(':');
      if (colon != std::string_view::npos && name.find(':') == std::string_view::npos) {
        one = std::min(one, compare_folded(folded, fold_name(candidate.substr(colon + 1))));
      }
      one.written_distance = one.is_far ? 0 : calc_edit_distance(name, candidate);
    }
    one.index = i;
    ranked.push_back(one);
  }
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(most, ranked.size()));
  std::partial_sort(ranked.begin(), end, ranked.end());
  ranked.erase(end, ranked.end());
  return ranked;
}

// Returns a name for a message. It can come from a file, and be long and unprintable.
std::string show_name(std::string_view name) {
  constexpr std::size_t kLongest_bytes = 100;
  return name.size() <= kLongest_bytes ? sanitize(name)
                                       : sanitize(name.substr(0, kLongest_bytes)) + "...";
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
  const std::vector<RankedName> ranked = rank_names(name, candidates, 1);
  return ranked.empty() || ranked.front().is_far ? std::nullopt
                                                 : std::optional(candidates[ranked[0].index]);
}

std::string list_valid(std::string_view name, std::span<const std::string> valid,
                       std::string_view list_command) {
  constexpr std::size_t kMostListed = 12;
  constexpr std::size_t kNearest = 3;
  std::vector<std::string> listed;
  if (valid.size() <= kMostListed) {
    std::ranges::transform(valid, std::back_inserter(listed), show_name);
    return listed.empty() ? "(none)" : join(listed, ", ");
  }
  for (const RankedName& ranked : rank_names(name, valid, kNearest)) {
    listed.push_back(show_name(valid[ranked.index]));
  }
  return fmt::format("{} and {} more{}", join(listed, ", "), valid.size() - listed.size(),
                     list_command.empty() ? "" : fmt::format(", which '{}' lists", list_command));
}

std::string describe_unknown(std::string_view what, std::string_view name,
                             std::span<const std::string> valid, std::string_view list_command) {
  auto nearest = find_nearest(name, valid);
  const auto longer = std::ranges::find_if(valid, [&](const std::string& one) {
    return one.starts_with(name) && 2 * name.size() >= one.size();
  });
  if (!nearest && longer != valid.end()) {
    nearest = *longer;
  }
  return fmt::format("unknown {} '{}'{} Valid: {}", what, show_name(name),
                     nearest ? fmt::format("; did you mean '{}'?", show_name(*nearest)) : ".",
                     list_valid(name, valid, list_command));
}

std::optional<double> parse_finite(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long long> parse_integer(std::string_view text) {
  return parse_whole<long long>(text);
}

std::optional<long long> parse_count(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789";
  constexpr long long kMostDigits = 18;  // of an integer of 64 bits, beside the first
  const std::size_t end = text.find_first_of("eEkM");
  if (end == std::string_view::npos) {
    return parse_integer(text);
  }
  const std::string_view unit = text.substr(end);
  std::optional<long long> power;
  if (unit == "k" || unit == "M") {
    power = unit == "k" ? 3 : 6;
  } else if (unit.front() != 'k' && unit.front() != 'M') {
    power = parse_integer(unit.substr(1));
  }
  if (!power || *power < 0 || *power > kMostDigits) {
    return std::nullopt;
  }
  // The decimal point moves to the right by `power` digits.
  const std::string_view number = text.substr(0, end);
  const std::size_t point = std::min(number.find('.'), number.size());
  std::string fraction(number.substr(std::min(point + 1, number.size())));
  while (fraction.ends_with('0')) {
    fraction.pop_back();
  }
  if (number.find_first_of(kDigits) == std::string_view::npos ||
      fraction.find_first_not_of(kDigits) != std::string::npos ||
      fraction.size() > static_cast<std::size_t>(*power)) {
    return std::nullopt;
  }
  fraction.resize(static_cast<std::size_t>(*power), '0');
  return parse_integer(std::string(number.substr(0, point)) + fraction);
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
