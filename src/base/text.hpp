// Small text helpers for messages and strict parsing. Nothing here depends on the locale.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// The candidate nearest to `name` by Damerau-Levenshtein distance (optimal string alignment), or
// nothing if none is near (more than a third of the letters differ). Ties go to the earlier
// candidate.
std::optional<std::string> find_nearest(std::string_view name,
                                        std::span<const std::string> candidates);

// "unknown optimizer 'gaa'; did you mean 'ga'? Valid: ga, random": one phrasing for every unknown
// name.
std::string describe_unknown(std::string_view what, std::string_view name,
                             std::span<const std::string> valid);

// The whole text as a number, or nothing: no blanks around it, no unit behind it, no comma. "nan"
// and "inf" are refused.
std::optional<double> parse_finite(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

std::vector<std::string> split(std::string_view text, char separator);
std::string join(std::span<const std::string> parts, std::string_view separator);

// The shortest decimal that reads back as exactly the same double.
std::string format_exact(double value);

// To a spreadsheet; or with the apostrophe that quote_csv() sets in front to keep it from being
// one.
bool begins_as_formula(std::string_view text);

// One field of a CSV file (RFC 4180).
std::string quote_csv(std::string_view text);

// The words as a POSIX shell would have to be given them.
std::string quote_command(std::span<const std::string> words);

// Printable UTF-8 for a terminal or a log: control characters (escape codes too) and invalid bytes
// become '?'.
std::string sanitize(std::string_view text);

// Whole UTF-8 sequences, none of which is a control character beyond ASCII.
bool is_utf8(std::string_view text);

}  // namespace armwright
