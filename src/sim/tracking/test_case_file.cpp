// Reads test cases from a CSV or JSON file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

constexpr std::size_t kLargestFile_bytes = std::size_t{256} << 20;
constexpr std::size_t kDeepestNesting = 8;  // the cases need 4, the rest is for ignored keys
constexpr int kLinesBetweenLooks = 256;     // at the limit of reading
constexpr double kFarthest_m = 100;         // coordinates beyond it are probably in millimetres
constexpr std::string_view kHeader = "case,point,x_m,y_m,z_m";

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw Error(ErrorKind::bad_data, where + ": " + what);
}

// Returns a part of the file for a message, made printable and shortened.
std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  return sanitize(text.substr(0, kLongest)) + (text.size() > kLongest ? "..." : "");
}

// Builds the cases from the parser's events. It stores only numbers in the right places, so memory
// does not depend on what else the file has.
class JsonCases final : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonCases(const std::string& name, std::string_view text) : name_(name), text_(text) {}

  std::vector<TestCase> finish() {
    if (!found_) {
      refuse(name_, "has no \"cases\"; it must be {\"cases\": [[[x, y, z], ...], ...]} in metres");
    }
    if (cases_.empty()) {
      refuse(name_, "\"cases\" is empty; it must hold at least one case");
    }
    return std::move(cases_);
  }

  bool null() override { return handle_other("null"); }
  bool boolean(bool value) override { return handle_other(value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override {
    // The parser calls this for numbers with a minus sign only, so a zero is the negative zero.
    return handle_number(value == 0 ? -0.0 : static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return handle_number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return handle_number(value); }
  bool string(string_t& value) override {
    return handle_other(fmt::format("\"{}\"", quote(value)));
  }
  bool binary(binary_t&) override { return handle_other("binary"); }

  bool key(string_t& key) override {
    if (depth_ == 1) {
      reading_ = key == "cases";
      if (reading_ && std::exchange(found_, true)) {
        refuse(name_, "has \"cases\" twice; it must have it once");
      }
    }
    return true;
  }

  bool start_object(std::size_t) override {
    if (depth_ > 0 && reading_) {
      handle_other("an object");
    }
    return enter();
  }
  bool end_object() override {
    --depth_;
    return true;
  }

  bool start_array(std::size_t) override {
    if (depth_ == 0) {
      refuse(name_, "is an array; it must be an object: {\"cases\": [[[x, y, z], ...], ...]}");
    }
    if (reading_ && depth_ == 2) {
      cases_.emplace_back();
    } else if (reading_ && depth_ == 3) {
      coordinates_ = 0;
    } else if (reading_ && depth_ == 4) {
      handle_other("an array");
    }
    return enter();
  }
  bool end_array() override {
    --depth_;
    if (reading_ && depth_ == 3) {
      if (coordinates_ != 3) {
        refuse(name_, fmt::format("{} has {} coordinates; it must have exactly 3: [x, y, z] in m",
                                  describe_point(), coordinates_));
      }
      cases_.back().points_m.emplace_back(point_[0], point_[1], point_[2]);
    } else if (reading_ && depth_ == 2) {
      if (const auto fault = find_fault(cases_.back())) {
        refuse(name_,
               fmt::format("case {}, point {} {}", cases_.size() - 1, fault->point, fault->what));
      }
    }
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(
                                         std::min(position > 0 ? position - 1 : 0, text_.size()));
    std::string_view what = error.what();
    what.remove_prefix(std::min(what.find("] "), what.size() - 2) +
                       2);  // the library's number of the error
    if (what.starts_with("parse error at ")) {
      what.remove_prefix(what.find(": ") + 2);
    }
    constexpr std::size_t kLongest = 300;
    refuse(fmt::format("{}:{}", name_, 1 + std::count(text_.begin(), end, '\n')),
           "is not valid JSON: " + sanitize(what.substr(0, kLongest)));
  }

 private:
  bool enter() {
    if (++depth_ > kDeepestNesting) {
      refuse(name_, fmt::format("is nested more than {} deep; test cases need 4", kDeepestNesting));
    }
    return true;
  }

  std::string describe_point() const {
    return fmt::format("case {}, point {}", cases_.size() - 1, cases_.back().points_m.size());
  }

  bool handle_number(double value) {
    if (!reading_ || depth_ != 4) {
      return !reading_ && depth_ > 0 ? true : handle_other(format_exact(value));
    }
    if (coordinates_ < point_.size()) {
      point_[coordinates_] = value;
    }
    ++coordinates_;
    return true;
  }

  // Handles every value but a number at its place: refuses it within the cases, ignores it
  // elsewhere.
  bool handle_other(const std::string& found) {
    if (depth_ == 0) {
      refuse(name_, fmt::format("is {}; it must be an object with the key \"cases\"", found));
    }
    if (!reading_) {
      return true;
    }
    switch (depth_) {
      case 1:
        refuse(name_, fmt::format("\"cases\" is {}; it must be an array of cases, each an array "
                                  "of points [x, y, z] in metres, the start first",
                                  found));
      case 2:
        refuse(name_,
               fmt::format("case {} is {}; it must be an array of points", cases_.size(), found));
      case 3:
        refuse(name_, fmt::format("{} is {}; it must be [x, y, z] in m", describe_point(), found));
      default:
        refuse(name_, fmt::format("{}, coordinate {} is {}; it must be a number, in m",
                                  describe_point(), coordinates_, found));
    }
  }

  const std::string& name_;
  std::string_view text_;
  std::size_t depth_ = 0;
  bool reading_ = false;  // within "cases"
  bool found_ = false;
  std::vector<TestCase> cases_;
  std::array<double, 3> point_{};
  std::size_t coordinates_ = 0;
};

std::vector<TestCase> parse_json(const std::string& name, std::string_view text) {
  JsonCases cases(name, text);
  nlohmann::json::sax_parse(text.begin(), text.end(), &cases);
  return cases.finish();
}

// Removes the text up to the separator, and the separator, and returns that text.
std::string_view cut_until(std::string_view& text, char separator) {
  const std::size_t at = text.find(separator);
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return part;
}

std::string_view cut_line(std::string_view& text) {
  std::string_view line = cut_until(text, '\n');
  if (line.ends_with('\r')) {  // RFC 4180 ends lines with CR LF
    line.remove_suffix(1);
  }
  return line;
}

struct CsvRow {
  long long number = 0;  // of the case
  long long point = 0;
  Eigen::Vector3d point_m;
};

CsvRow parse_row(const std::string& where, std::string_view line) {
  const auto fields = 1 + std::count(line.begin(), line.end(), ',');
  if (fields != 5) {
    refuse(where, fmt::format("a row must have exactly 5 fields: {}; '{}' has {}", kHeader,
                              quote(line), fields));
  }
  const auto parse_next_integer = [&](const char* column) {
    const std::string_view field = cut_until(line, ',');
    const auto value = parse_integer(field);
    if (!value || *value < 0) {
      refuse(where, fmt::format("{} is '{}'; it must be an integer >= 0", column, quote(field)));
    }
    return *value;
  };
  const auto parse_next_number = [&](const char* column) {
    const std::string_view field = cut_until(line, ',');
    const auto value = parse_finite(field);
    if (!value) {
      refuse(where, fmt::format("{} is '{}'; it must be a finite number, in m, with nothing around",
                                column, quote(field)));
    }
    return *value;
  };
  CsvRow row;
  row.number = parse_next_integer("case");
  row.point = parse_next_integer("point");
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::array<const char*, 3> kColumns = {"x_m", "y_m", "z_m"};
    row.point_m[axis] = parse_next_number(kColumns[static_cast<std::size_t>(axis)]);
  }
  return row;
}

std::vector<TestCase> parse_csv(const std::string& name, std::string_view text) {
  std::size_t line_number = 1;
  const std::string_view header = cut_line(text);
  if (header != kHeader) {
    refuse(name + ":1", fmt::format("the first line is '{}'; it must be {} (CSV), or the file must "
                                    "begin with {{ (JSON)",
                                    quote(header), kHeader));
  }
  std::vector<TestCase> cases;
  std::size_t first_line = 0;  // of the last case
  const auto finish_case = [&] {
    if (cases.empty()) {
      return;
    }
    if (const auto fault = find_fault(cases.back())) {
      refuse(fmt::format("{}:{}", name, first_line + fault->point),
             fmt::format("case {}, point {} {}", cases.size() - 1, fault->point, fault->what));
    }
  };
  while (!text.empty()) {
    if (line_number % kLinesBetweenLooks == 0) {
      check_reading();
    }
    const std::string where = fmt::format("{}:{}", name, ++line_number);
    const CsvRow row = parse_row(where, cut_line(text));
    const auto current = static_cast<long long>(cases.size()) - 1;
    const auto next_point =
        cases.empty() ? 0 : static_cast<long long>(cases.back().points_m.size());
    if (row.number == current + 1 && row.point == 0) {
      finish_case();
      cases.emplace_back();
      first_line = line_number;
    } else if (row.number != current || row.point != next_point) {
      refuse(where,
             fmt::format(
                 "is case {}, point {}; it must be {}case {}, point 0: cases and "
                 "their points are counted from 0, in order, without gaps",
                 row.number, row.point,
                 cases.empty() ? "" : fmt::format("case {}, point {} or ", current, next_point),
                 current + 1));
    }
    cases.back().points_m.push_back(row.point_m);
  }
  finish_case();
  if (cases.empty()) {
    refuse(name, "has no rows below its header; it must hold at least one case");
  }
  return cases;
}

}  // namespace

std::optional<CaseFault> find_fault(const TestCase& test_case) {
  const auto& points_m = test_case.points_m;
  if (points_m.size() < 2) {
    return CaseFault{0, fmt::format("is {}; a case must have at least 2 points: the start and "
                                    "where to go",
                                    points_m.empty() ? "missing" : "its only one")};
  }
  for (std::size_t k = 0; k < points_m.size(); ++k) {
    for (const double coordinate_m : points_m[k]) {
      if (!(std::abs(coordinate_m) <= kFarthest_m)) {
        return CaseFault{k, fmt::format("has the coordinate {} m; it must lie within +-{} m (are "
                                        "the coordinates in metres?)",
                                        format_exact(coordinate_m), kFarthest_m)};
      }
    }
    if (k > 0 && (points_m[k] - points_m[k - 1]).norm() == 0) {
      return CaseFault{k,
                       "is where the point before is; each point must differ from the one "
                       "before it"};
    }
  }
  return std::nullopt;
}

std::vector<TestCase> parse_test_cases(std::string_view text, const std::string& name) {
  if (text.starts_with("\xEF\xBB\xBF")) {  // spreadsheets write a byte order mark before UTF-8
    text.remove_prefix(3);
  }
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) {
    refuse(name, "is empty; it must be JSON with \"cases\" or CSV with the header " +
                     std::string(kHeader));
  }
  return text[first] == '{' || text[first] == '[' ? parse_json(name, text) : parse_csv(name, text);
}

std::vector<TestCase> read_test_cases(const std::filesystem::path& file) {
  const ReadStep step(fmt::format("the test cases {}", sanitize(file.string())));
  return parse_test_cases(read_input(file, kLargestFile_bytes), sanitize(file.string()));
}

}  // namespace armwright
