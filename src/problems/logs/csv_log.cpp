#include "problems/logs/csv_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostColumns = 10'000;
constexpr std::size_t kLinesBetweenLooksAtLimit = 1024;

[[noreturn]] void refuse_line(const std::string& file, std::size_t line, const std::string& what) {
  throw Error(ErrorKind::bad_data, fmt::format("{}:{}: {}", file, line, what));
}

std::string_view trim_field(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string_view unquote_field(std::string_view field) {
  field = trim_field(field);
  return field.size() >= 2 && field.front() == '"' && field.back() == '"'
             ? field.substr(1, field.size() - 2)
             : field;
}

// Splits off the next field. Names may have separators between quotes.
std::string_view take_field(std::string_view& line, char separator, bool& is_last) {
  std::size_t from = 0;
  if (trim_field(line).starts_with('"')) {
    const std::size_t open = line.find('"');
    const std::size_t close = line.find('"', open + 1);
    from = close == std::string_view::npos ? 0 : close;
  }
  const std::size_t end = line.find(separator, from);
  is_last = end == std::string_view::npos;
  const std::string_view field = line.substr(0, end);
  line.remove_prefix(is_last ? line.size() : end + 1);
  return field;
}

// Returns NaN for an empty field and for what programs write in place of a number that they lack.
double read_field(std::string_view text, const std::string& file, std::size_t line,
                  const std::string& column) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::string_view field = unquote_field(text);
  if (field.empty()) {
    return kNan;
  }
  if (field.front() == '+') {
    field.remove_prefix(1);
  }
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error == std::errc::result_out_of_range && end == field.data() + field.size()) {
    // Too small for a double, as 5.3e-430, or too large.
    return field.find("e-") != std::string_view::npos || field.find("E-") != std::string_view::npos
               ? 0
               : kNan;
  }
  if (error != std::errc{} || end != field.data() + field.size()) {
    const bool has_comma = field.find(',') != std::string_view::npos;
    refuse_line(file, line,
                fmt::format("column {} is {}, which is no number{}", quote_name(column),
                            quote_name(field), has_comma ? "; decimals need a point" : ""));
  }
  return std::isfinite(value) ? value : kNan;
}

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next(std::string_view& line) {
    if (rest_.empty()) {
      return false;
    }
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }
  std::size_t number() const { return number_; }
  bool has_more() const { return !trim_all(rest_).empty(); }

 private:
  static std::string_view trim_all(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first == std::string_view::npos ? std::string_view() : text.substr(first);
  }
  std::string_view rest_;
  std::size_t number_ = 0;
};

std::vector<std::string> read_header(Lines& lines, const std::string& file, char& separator) {
  std::string_view line;
  while (lines.next(line)) {
    line = trim_field(line);
    if (!line.empty() && line.front() != '#') {
      break;
    }
    line = {};
  }
  if (line.empty()) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: is empty; a log needs a line with the names of its columns and one "
                    "line per sample",
                    file));
  }
  separator = ',';
  for (const char other : {';', '\t'}) {
    if (std::ranges::count(line, other) > std::ranges::count(line, separator)) {
      separator = other;
    }
  }
  std::vector<std::string> header;
  for (bool is_last = false; !is_last;) {
    header.emplace_back(unquote_field(take_field(line, separator, is_last)));
    if (header.size() > kMostColumns) {
      refuse_line(file, lines.number(),
                  fmt::format("there are more than {} columns", kMostColumns));
    }
  }
  if (std::ranges::all_of(header,
                          [](const std::string& name) { return parse_finite(name).has_value(); })) {
    refuse_line(file, lines.number(),
                "the first line has numbers; it must have the names of the columns, such as "
                "time_s,position_1_rad,effort_1_n_m");
  }
  return header;
}

}  // namespace

Recording read_csv_log(std::string_view text, const std::string& file, const LogColumns& columns) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  Lines lines(text);
  char separator = ',';
  const std::vector<std::string> header = read_header(lines, file, separator);
  LogLayout layout = columns.match(header, fmt::format("{}:{}", file, lines.number()));
  Recording recording;
  recording.file = file;
  recording.first_row = lines.number() + 1;
  recording.time_name = layout.time_name;
  // Where the field of each place goes: to the time, to a column, or nowhere.
  std::vector<std::vector<double>*> goals(header.size(), nullptr);
  std::vector<double> factors(header.size(), 1);
  goals[layout.time] = &recording.times_s;
  factors[layout.time] = layout.time_factor_s;
  recording.columns = std::move(layout.columns);
  for (std::size_t i = 0; i < recording.columns.size(); ++i) {
    goals[layout.places[i]] = &recording.columns[i].values;
    factors[layout.places[i]] = recording.columns[i].factor;
  }
  std::string_view line;
  while (lines.next(line)) {
    if (lines.number() % kLinesBetweenLooksAtLimit == 0) {
      check_reading();
    }
    if (trim_field(line).empty()) {
      if (lines.has_more()) {
        refuse_line(file, lines.number(), "the line is empty; remove it");
      }
      break;
    }
    const std::string_view whole = line;
    std::size_t place = 0;
    for (bool is_last = false; !is_last; ++place) {
      const std::string_view field = take_field(line, separator, is_last);
      if (place < goals.size() && goals[place] != nullptr) {
        goals[place]->push_back(factors[place] *
                                read_field(field, file, lines.number(), header[place]));
      }
    }
    if (place != header.size()) {
      refuse_line(
          file, lines.number(),
          fmt::format("there are {} fields for {} columns{}", place, header.size(),
                      place < header.size() && !lines.has_more() &&
                              whole.data() + whole.size() == text.data() + text.size()
                          ? "; the file ends within this line, so the recording was cut off; "
                            "remove the line or record again"
                          : ""));
    }
  }
  return recording;
}

}  // namespace armwright
