// Reads files with the results of points: JSON lines or CSV.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "problems/user/case_messages.hpp"
#include "problems/user/user_problem.hpp"
#include "process/csv_reader.hpp"
#include "process/json_message.hpp"
#include "study/run/ask_tell.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kMissing = "missing";
constexpr std::size_t kLongestReason = 300;

[[noreturn]] void refuse(const std::string& where, const std::string& fault) {
  throw Error(ErrorKind::bad_data, fmt::format("{}: {}", where, fault));
}

CaseAnswer make_missing(const std::string& reason, const std::string& where) {
  if (reason.empty()) {
    refuse(where, "\"missing\" is empty; it must say why there is no result");
  }
  CaseAnswer answer;
  answer.status = EvaluationStatus::failed;
  answer.reason = sanitize(reason.substr(0, kLongestReason));
  return answer;
}

// Refuses fields that no answer has: a misspelt one would otherwise be ignored.
void check_fields(const json& line, const std::string& where) {
  static constexpr std::array<std::string_view, 8> kFields = {
      "id", kMissing, "objectives", "constraints", "metrics", "residuals", "status", "reason"};
  for (const auto& [key, value] : line.items()) {
    if (std::ranges::find(kFields, key) == kFields.end()) {
      refuse(where, describe_unknown("field", key,
                                     std::vector<std::string>(kFields.begin(), kFields.end())));
    }
  }
}

ToldAnswer read_json_line(const std::string& text, const std::string& where,
                          const UserDescription& description) {
  check_json_depth(text, where);
  const json line = json::parse(text, nullptr, false);
  if (!line.is_object()) {
    refuse(where, fmt::format("is {}, not a JSON object as in {{\"id\": 3, \"objectives\": [0.5]}}",
                              quote(text)));
  }
  const auto id = line.find("id");
  if (id == line.end() || !id->is_number_unsigned()) {
    refuse(where,
           fmt::format("its \"id\" is {}; it must be the number that 'armwright ask' printed",
                       id == line.end() ? "missing" : quote(*id)));
  }
  check_fields(line, where);
  ToldAnswer told{.id = id->get<std::uint64_t>(), .answer = {}, .where = where};
  try {
    told.answer = line.contains(kMissing)
                      ? make_missing(read_text(line, kMissing, "a result"), where)
                      : read_answer(line, description, "a result");
  } catch (const ProtocolError& error) {
    refuse(where, fmt::format("this line {}", error.what()));
  }
  return told;
}

std::vector<ToldAnswer> read_json_lines(std::string_view text, const std::string& name,
                                        const UserDescription& description) {
  std::vector<ToldAnswer> answers;
  std::size_t number = 0;
  for (const std::string& line : split(text, '\n')) {
    const std::string where = fmt::format("{}:{}", name, ++number);
    if (line.find_first_not_of(" \t\r") != std::string::npos) {
      answers.push_back(read_json_line(line, where, description));
    }
  }
  return answers;
}

// The columns of a CSV file and what they mean.
class CsvColumns {
 public:
  CsvColumns(const std::vector<std::string>& header, const std::string& where,
             const UserDescription& description)
      : header_(header) {
    std::vector<std::string> known = {"id", kMissing};
    const auto add = [&](std::vector<std::size_t>& places, const std::string& name) {
      if (std::ranges::count(known, name) > 0) {
        refuse(where, fmt::format("two numbers of the problem are called '{}', so CSV cannot tell "
                                  "them apart; use JSON lines",
                                  sanitize(name)));
      }
      known.push_back(name);
      places.push_back(find(name));
      if (places.back() == header_.size()) {
        refuse(where, fmt::format("has no column '{}'", sanitize(name)));
      }
    };
    for (const UserObjective& objective : description.objectives) {
      add(objectives_, objective.quantity.name);
    }
    for (const UserConstraint& constraint : description.constraints) {
      add(constraints_, constraint.quantity.name);
    }
    for (const Quantity& metric : description.metrics) {
      add(metrics_, metric.name);
    }
    for (const DecisionVariable& variable : description.variables) {
      known.push_back(variable.name);
    }
    for (const std::string& column : header_) {
      if (std::ranges::count(known, column) == 0) {
        refuse(where, describe_unknown("column", column, known));
      }
      if (std::ranges::count(header_, column) > 1) {
        refuse(where, fmt::format("has the column '{}' twice", sanitize(column)));
      }
    }
    if (find("id") == header_.size()) {
      refuse(where, "has no column 'id'; the first line names the columns");
    }
  }

  ToldAnswer read(const std::vector<std::string>& row, const std::string& where) const {
    if (row.size() != header_.size()) {
      refuse(where, fmt::format("has {} fields, but the header {}", row.size(), header_.size()));
    }
    const auto id = parse_integer(row[find("id")]);
    if (!id || *id < 0) {
      refuse(where,
             fmt::format("its id is '{}'; it must be the number that 'armwright ask' printed",
                         sanitize(row[find("id")])));
    }
    ToldAnswer told{.id = static_cast<std::uint64_t>(*id), .answer = {}, .where = where};
    const std::size_t missing = find(kMissing);
    if (missing < row.size() && !row[missing].empty()) {
      told.answer = make_missing(row[missing], where);
      return told;
    }
    told.answer.objectives = read_numbers(row, objectives_, where);
    told.answer.constraints = read_numbers(row, constraints_, where);
    told.answer.metrics = read_numbers(row, metrics_, where);
    return told;
  }

 private:
  std::size_t find(std::string_view name) const {
    return static_cast<std::size_t>(std::ranges::find(header_, name) - header_.begin());
  }

  std::vector<double> read_numbers(const std::vector<std::string>& row,
                                   const std::vector<std::size_t>& places,
                                   const std::string& where) const {
    std::vector<double> numbers;
    for (const std::size_t place : places) {
      const auto number = parse_finite(row[place]);
      if (!number) {
        refuse(where, fmt::format("its '{}' is '{}'; it must be a finite number. If there is no "
                                  "result, give the reason in a column 'missing'",
                                  sanitize(header_[place]), sanitize(row[place])));
      }
      numbers.push_back(*number);
    }
    return numbers;
  }

  std::vector<std::string> header_;
  std::vector<std::size_t> objectives_, constraints_, metrics_;
};

std::vector<ToldAnswer> read_csv(std::string_view text, const std::string& name,
                                 const UserDescription& description) {
  std::vector<ToldAnswer> answers;
  CsvReader reader(text);
  std::vector<std::string> row;
  std::optional<CsvColumns> columns;
  try {
    while (reader.read_row(row)) {
      const std::string where = fmt::format("{}:{}", name, reader.row());
      if (!columns) {
        columns.emplace(row, where, description);
      } else if (row.size() > 1 || !row.front().empty()) {
        answers.push_back(columns->read(row, where));
      }
    }
  } catch (const Error& error) {
    const std::string what = error.what();
    if (what.starts_with(name + ":")) {
      throw;
    }
    refuse(fmt::format("{}:{}", name, reader.row()), what);
  }
  return answers;
}

}  // namespace

std::vector<ToldAnswer> read_told(std::string_view text, const std::string& name,
                                  const Problem& problem) {
  const UserDescription& description = *find_user_description(problem);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) {
    return {};
  }
  return text[first] == '{' ? read_json_lines(text, name, description)
                            : read_csv(text, name, description);
}

}  // namespace armwright
