#include "problems/user/result_reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "process/json_message.hpp"

namespace armwright {
namespace {

// The library's matcher needs stack for every character, so a longer line is searched only so far.
constexpr std::size_t kLongestSearched = 4096;

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos
             ? ""
             : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string describe_source(const std::string& from) {
  return from == ResultReading::kStandardOutput ? "its standard output" : quote(from);
}

// Returns the number that a text has. Simulators also write "+1.5".
double to_number(std::string_view text, const std::string& where, const std::string& place = "") {
  std::string_view digits = trim(text);
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') {
    digits.remove_prefix(1);
  }
  if (const auto number = parse_finite(digits)) {
    return *number;
  }
  throw MissingResult(fmt::format("{} is not a finite number", where),
                      fmt::format("; it is {}{}", quote(std::string(text)), place));
}

// Calls `use` with each line that is not empty, until it returns false.
void each_line(std::string_view text, const std::function<bool(std::string_view)>& use) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    if (!line.empty() && !use(line)) {
      return;
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

// Splits lines of a table at the separator that the first line has: a comma, a semicolon, a tab, or
// otherwise blanks.
class FieldSplitter {
 public:
  explicit FieldSplitter(std::string_view first_line) {
    for (const char separator : {',', ';', '\t'}) {
      if (first_line.find(separator) != std::string_view::npos) {
        separator_ = separator;
        return;
      }
    }
  }
  std::vector<std::string_view> split(std::string_view line) const {
    std::vector<std::string_view> fields;
    while (true) {
      if (separator_ == ' ') {
        line = trim(line);
        if (line.empty()) {
          return fields;
        }
      }
      const std::size_t end = separator_ == ' ' ? line.find_first_of(" \t") : line.find(separator_);
      fields.push_back(unquote(trim(line.substr(0, end))));
      if (end == std::string_view::npos) {
        return fields;
      }
      line.remove_prefix(end + 1);
    }
  }

 private:
  static std::string_view unquote(std::string_view field) {
    const bool is_quoted = field.size() > 1 && field.front() == '"' && field.back() == '"';
    return is_quoted ? field.substr(1, field.size() - 2) : field;
  }

  char separator_ = ' ';
};

double read_column(const std::string& text, const ResultReading& reading) {
  const std::string source = describe_source(reading.from);
  std::optional<FieldSplitter> splitter;
  std::size_t column = 0;
  std::size_t line_number = 0;
  std::optional<double> result;
  double sum = 0;
  std::size_t count = 0;
  each_line(text, [&](std::string_view line) {
    ++line_number;
    if (!splitter) {
      if (line.front() == '#') {
        line = trim(line.substr(1));
      }
      splitter.emplace(line);
      const auto names = splitter->split(line);
      const auto found = std::ranges::find(names, std::string_view(reading.what));
      const auto number = parse_integer(reading.what);
      if (found == names.end() && !(number && *number >= 1 && *number <= std::ssize(names))) {
        throw MissingResult(fmt::format("{} has no column {}", source, quote(reading.what)),
                            fmt::format("; its first line is {}", quote(std::string(line))));
      }
      column = found != names.end() ? static_cast<std::size_t>(found - names.begin())
                                    : static_cast<std::size_t>(*number - 1);
      // A first line of numbers is no header.
      if (found != names.end() || !parse_finite(names[column])) {
        return true;
      }
    }
    const auto fields = splitter->split(line);
    const std::string where = fmt::format("column {} of {}", quote(reading.what), source);
    const std::string row = fmt::format(" in row {}", line_number);
    if (column >= fields.size()) {
      throw MissingResult(fmt::format("{} is too short", where), "; it ends" + row);
    }
    const double value = to_number(fields[column], where, row);
    sum += value;
    ++count;
    const bool replaces = !result || reading.row == ColumnRow::last ||
                          (reading.row == ColumnRow::max && value > *result) ||
                          (reading.row == ColumnRow::min && value < *result);
    if (replaces) {
      result = value;
    }
    return reading.row != ColumnRow::first;
  });
  if (!result) {
    throw MissingResult(
        fmt::format("{} has no row with the column {}", source, quote(reading.what)));
  }
  return reading.row == ColumnRow::mean ? sum / static_cast<double>(count) : *result;
}

double read_match(const std::string& text, const ResultReading& reading) {
  std::optional<std::string> found;
  each_line(text, [&](std::string_view line) {
    line = line.substr(0, kLongestSearched);
    std::match_results<std::string_view::const_iterator> match;
    if (std::regex_search(line.begin(), line.end(), match, reading.pattern)) {
      found = match[1].str();
    }
    return true;
  });
  const std::string source = describe_source(reading.from);
  if (!found) {
    throw MissingResult(fmt::format("{} has no line that matches {}", source, quote(reading.what)));
  }
  return to_number(*found, fmt::format("the match of {} in {}", quote(reading.what), source));
}

}  // namespace

CommandResults::CommandResults(const std::filesystem::path& folder,
                               std::optional<std::string> output, int exit_code)
    : folder_(folder), exit_code_(exit_code) {
  if (output) {
    texts_[ResultReading::kStandardOutput] = *std::move(output);
  }
}

const std::string& CommandResults::get_text(const std::string& from) {
  if (const auto known = texts_.find(from); known != texts_.end()) {
    return known->second;
  }
  if (from == ResultReading::kStandardOutput) {
    throw MissingResult(
        fmt::format("its standard output is longer than {} MiB", kMostResult_bytes >> 20));
  }
  const std::filesystem::path file = folder_ / from;
  try {
    if (!path_exists(file)) {
      throw MissingResult(fmt::format("it wrote no file {}", quote(from)));
    }
    return texts_[from] = read_file(file, kMostResult_bytes);
  } catch (const Error& error) {
    // The message of the error would have the path of the working folder, which differs each time.
    throw MissingResult(fmt::format("{} is no readable file of at most {} MiB", quote(from),
                                    kMostResult_bytes >> 20));
  }
}

const nlohmann::json& CommandResults::get_json(const std::string& from) {
  if (const auto known = parsed_.find(from); known != parsed_.end()) {
    return known->second;
  }
  const std::string& text = get_text(from);
  const std::string source = describe_source(from);
  try {
    check_json_depth(text, source);
    return parsed_[from] = nlohmann::json::parse(text);
  } catch (const Error& error) {
    throw MissingResult(fmt::format("{} is not JSON of a usual depth", source),
                        fmt::format(" ({})", error.what()));
  } catch (const nlohmann::json::exception& error) {
    throw MissingResult(fmt::format("{} is not JSON", source),
                        fmt::format(" ({})", describe_json_error(error.what())));
  }
}

double CommandResults::read(const ResultReading& reading) {
  switch (reading.kind) {
    case ResultReading::Kind::exit_code:
      return exit_code_;
    case ResultReading::Kind::column:
      return read_column(get_text(reading.from), reading);
    case ResultReading::Kind::regex:
      return read_match(get_text(reading.from), reading);
    case ResultReading::Kind::json:
      break;
  }
  const nlohmann::json& all = get_json(reading.from);
  const nlohmann::json::json_pointer pointer(reading.what);
  const std::string source = describe_source(reading.from);
  const auto find = [&]() -> nlohmann::json {
    try {
      return all.at(pointer);
    } catch (const nlohmann::json::exception&) {  // no such place, or an index beyond all numbers
      throw MissingResult(fmt::format("{} has nothing at {}", source, quote(reading.what)));
    }
  };
  const nlohmann::json value = find();
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    throw MissingResult(fmt::format("{} has no finite number at {}", source, quote(reading.what)),
                        fmt::format("; it has {}", quote(value)));
  }
  return value.get<double>();
}

}  // namespace armwright
