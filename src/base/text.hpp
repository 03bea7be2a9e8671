// Functions on text, for messages and for strict parsing. None of them depends on the locale.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// Returns the candidate nearest to `name` by Damerau-Levenshtein distance (optimal string
// alignment). Capital letters and the characters - _ : and blank make no difference. A name without
// ':' is also compared with the part of a candidate behind its last ':' ("cobyla" with
// "nlopt:cobyla"). Returns nothing if more than a third of the letters differ. If several candidates
// are equally near, returns the first.
std::optional<std::string> find_nearest(std::string_view name,
                                        std::span<const std::string> candidates);

// Returns the message for an unknown name: "unknown optimizer 'gaa'; did you mean 'ga'? Valid: ga,
// random". If no name is near, it suggests the first valid name of which `name` is the first half or
// more ("cma" of "cmaes"). `list_command` is as in list_valid().
std::string describe_unknown(std::string_view what, std::string_view name,
                             std::span<const std::string> valid,
                             std::string_view list_command = {});

// Returns the valid names in place of `name`: "ga, random". Of more than 12 names it returns the
// three nearest, how many more there are, and the command that lists them: "ga, de, lhs and 54
// more, which 'armwright list optimizers' lists". Without such a command, `list_command` is empty.
std::string list_valid(std::string_view name, std::span<const std::string> valid,
                       std::string_view list_command = {});

// Return the whole text as a number. Return nothing for blanks around it, a unit after it, a
// decimal comma, "nan" or "inf".
std::optional<double> parse_finite(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

// Returns the whole text as a count: an integer, also with an exponent (1e3 is 1000), or with k or M
// for thousands or millions (10k, 1.5M). Computes exactly. Returns nothing for a number that is no
// integer, for one beyond 64 bits, for a negative exponent, and for a fraction without exponent, k
// or M.
std::optional<long long> parse_count(std::string_view text);

std::vector<std::string> split(std::string_view text, char separator);
std::string join(std::span<const std::string> parts, std::string_view separator);

// Returns the shortest decimal text that reads back as exactly the same double.
std::string format_exact(double value);

// Returns the value with `digits` significant digits and its unit, for messages: "3.14 rad". A value
// that is no finite number has words in place of both: "not a number", "infinite", "minus infinite".
std::string describe_number(double value, std::string_view unit, int digits = 4);

// Returns whether a spreadsheet would take the text for a formula, or whether it begins with the
// apostrophe that quote_csv() adds to prevent this.
bool begins_as_formula(std::string_view text);

// Returns the text as one field of a CSV file (RFC 4180).
std::string quote_csv(std::string_view text);

// Returns the words quoted for a POSIX shell.
std::string quote_command(std::span<const std::string> words);

// Returns printable UTF-8 for a terminal or a log. Control characters, also of escape codes, and
// invalid bytes become '?'.
std::string sanitize(std::string_view text);

// Returns whether the text consists of complete UTF-8 sequences without control characters beyond
// ASCII.
bool is_utf8(std::string_view text);

}  // namespace armwright
