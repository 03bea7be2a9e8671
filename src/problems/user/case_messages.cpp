#include "problems/user/case_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/base64.hpp"
#include "base/random.hpp"
#include "base/text.hpp"
#include "process/json_message.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestReason = 300;
constexpr std::size_t kMostSeries = 200;
constexpr std::size_t kMostRecordFiles = 20;
constexpr std::size_t kMostSignalPoints = 1'000'000;  // of one signal

// Appends a number so that a reader sees its type: whole numbers of real variables have a point.
void append_value(const DecisionVariable& variable, double value, std::string& text) {
  if (variable.type == VariableType::category) {
    text += json(format_value(variable, value)).dump();
    return;
  }
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{}", value);
  if (variable.type == VariableType::real &&
      text.find_first_of(".en", begin) == std::string::npos) {
    text += ".0";
  }
}

double read_value(const json& value, const std::string& where, std::string_view name) {
  if (value.is_null()) {
    return std::numeric_limits<double>::quiet_NaN();  // a failed case, see UserProblem
  }
  if (!value.is_number()) {
    throw ProtocolError(fmt::format("sent {} whose value of '{}' is {}, not a number", where,
                                    sanitize(name), quote(value)));
  }
  return value.get<double>();
}

// Reads a list of numbers, one per name.
template <class Named, class GetName>
std::vector<double> read_values(const json& answer, const char* key, std::span<const Named> named,
                                GetName get_name, const std::string& where) {
  std::vector<double> values;
  const auto list = answer.find(key);
  if (list == answer.end() && named.empty()) {
    return values;
  }
  if (list == answer.end() || !list->is_array() || list->size() != named.size()) {
    throw ProtocolError(fmt::format("sent {} whose \"{}\" are {}; the description has {} of them",
                                    where, key, list == answer.end() ? "missing" : quote(*list),
                                    named.size()));
  }
  for (std::size_t i = 0; i < named.size(); ++i) {
    values.push_back(read_value((*list)[i], where, get_name(named[i])));
  }
  return values;
}

EvaluationStatus read_status(const json& answer, const std::string& where) {
  if (!answer.contains("status")) {
    return EvaluationStatus::ok;
  }
  const std::string status = read_text(answer, "status", where);
  for (const auto known : {EvaluationStatus::ok, EvaluationStatus::failed,
                           EvaluationStatus::diverged, EvaluationStatus::unreachable}) {
    if (status == to_string(known)) {
      return known;
    }
  }
  throw ProtocolError(
      fmt::format("sent {} with the status {}; possible are \"ok\", \"failed\", \"diverged\" and "
                  "\"unreachable\"",
                  where, quote(status)));
}

void check_id(const json& message, std::uint64_t id) {
  const json& sent = require(message, "id", "an answer");
  if (!sent.is_number_integer() || sent != id) {
    throw ProtocolError(
        fmt::format("answered the question {}; it was asked question {}", quote(sent), id));
  }
}

// Reads a list of finite numbers.
std::vector<double> read_points(const json& object, const std::string& where) {
  const json& list = require(object, "values", where);
  if (!list.is_array() || list.size() > kMostSignalPoints) {
    throw ProtocolError(fmt::format("sent {} whose \"values\" are not a list of at most {} numbers",
                                    where, kMostSignalPoints));
  }
  std::vector<double> values;
  for (const json& value : list) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      throw ProtocolError(
          fmt::format("sent {} with the value {}, not a finite number", where, quote(value)));
    }
    values.push_back(value.get<double>());
  }
  return values;
}

Quantity read_quantity_of(const json& object, const std::string& where) {
  return {read_name(object, where),
          object.contains("unit") ? read_text(object, "unit", where) : ""};
}

// Returns the content of a file, which the message has as text or as base64.
std::string read_content(const json& file, const std::string& where) {
  const char* const key = file.contains("text") ? "text" : "base64";
  const json& content = require(file, key, where);
  if (content.is_string() && key == std::string_view("text")) {
    return content.get<std::string>();
  }
  auto bytes = from_base64(content.is_string() ? content.get_ref<const std::string&>() : "?");
  if (!bytes) {
    throw ProtocolError(fmt::format("sent {} whose \"{}\" is {}", where, key, quote(content)));
  }
  return std::move(*bytes);
}

// Returns the list under `key`; an empty one if it is missing.
const json& get_list(const json& message, const char* key, std::size_t most) {
  static const json kNone = json::array();
  const auto list = message.find(key);
  if (list == message.end()) {
    return kNone;
  }
  if (!list->is_array() || list->size() > most) {
    throw ProtocolError(
        fmt::format("sent a record whose \"{}\" are not a list of at most {}", key, most));
  }
  return *list;
}

}  // namespace

std::uint64_t calc_case_seed(const CaseBlock& block, std::uint64_t number) {
  return RandomStream("case seed/" + block.set, number).next_u64() >> 11;
}

std::string make_question(const UserDescription& description, const char* type, std::uint64_t id,
                          std::span<const CaseJob> jobs) {
  const CaseBlock& block = *jobs.front().block;
  static constexpr const char* kRoles[] = {"training", "validation", "test"};
  std::string text = fmt::format(R"({{"type":"{}","id":{},"role":"{}","set":{},"points":[)", type,
                                 id, kRoles[static_cast<int>(block.role)], json(block.set).dump());
  for (const CaseJob& job : jobs) {
    text += &job == jobs.data() ? "[" : ",[";
    for (std::size_t i = 0; i < job.x.size(); ++i) {
      if (i > 0) {
        text += ',';
      }
      append_value(description.variables[i], job.x[i], text);
    }
    text += ']';
  }
  text += "],\"cases\":[";
  for (const CaseJob& job : jobs) {
    fmt::format_to(std::back_inserter(text), "{}{}", &job == jobs.data() ? "" : ",", job.number);
  }
  if (!has_single_case(description)) {
    text += "],\"seeds\":[";
    for (const CaseJob& job : jobs) {
      fmt::format_to(std::back_inserter(text), "{}{}", &job == jobs.data() ? "" : ",",
                     calc_case_seed(block, job.number));
    }
  }
  return text +
         (jobs.front().residuals && description.has_residuals ? "],\"residuals\":true}" : "]}");
}

void check_answer(const CaseAnswer& answer, const UserDescription& description,
                  const std::string& where) {
  const auto check = [&](std::size_t count, std::size_t expected, const char* what) {
    if (count != expected) {
      throw ProtocolError(
          fmt::format("sent {} with {} {}; the description has {}", where, count, what, expected));
    }
  };
  check(answer.objectives.size(), description.objectives.size(), "objectives");
  check(answer.constraints.size(), description.constraints.size(), "constraints");
  check(answer.metrics.size(), description.metrics.size(), "metrics");
}

CaseAnswer read_answer(const json& answer, const UserDescription& description,
                       const std::string& where) {
  CaseAnswer read;
  if (answer.is_number() || answer.is_null()) {  // the short form of one objective
    read.objectives = {read_value(answer, where, description.objectives.front().quantity.name)};
    check_answer(read, description, where);
    return read;
  }
  if (!answer.is_object()) {
    throw ProtocolError(
        fmt::format("sent {} that is no object and no number: {}", where, quote(answer)));
  }
  read.status = read_status(answer, where);
  if (read.status != EvaluationStatus::ok) {
    read.reason = answer.contains("reason") ? read_text(answer, "reason", where) : "";
    read.reason = sanitize(read.reason.substr(0, kLongestReason));
    return read;
  }
  const auto name_of = [](const auto& one) -> const std::string& { return one.quantity.name; };
  read.objectives =
      read_values(answer, "objectives", std::span(description.objectives), name_of, where);
  read.constraints =
      read_values(answer, "constraints", std::span(description.constraints), name_of, where);
  read.metrics = read_values(
      answer, "metrics", std::span(description.metrics),
      [](const Quantity& metric) -> const std::string& { return metric.name; }, where);
  if (const auto list = answer.find("residuals"); list != answer.end()) {
    if (!list->is_array()) {
      throw ProtocolError(
          fmt::format("sent {} whose \"residuals\" are {}, not a list", where, quote(*list)));
    }
    for (const json& value : *list) {
      read.residuals.push_back(read_value(value, where, "residuals"));
    }
  }
  return read;
}

void read_answers(const json& message, const UserDescription& description, std::uint64_t id,
                  std::size_t most, std::vector<CaseAnswer>& answers) {
  if (read_type(message) != "answers") {
    throw ProtocolError(
        fmt::format("answered \"evaluate\" with a message of the type {}; it must "
                    "be \"answers\"",
                    quote(read_type(message))));
  }
  check_id(message, id);
  const json& list = require(message, "answers", "an answer");
  if (!list.is_array() || list.empty()) {
    throw ProtocolError(
        fmt::format("sent no answers: \"answers\" is {}, not a list of answers", quote(list)));
  }
  if (list.size() > most) {
    throw ProtocolError(fmt::format("sent {} answers too many", list.size() - most));
  }
  for (const json& answer : list) {
    answers.push_back(
        read_answer(answer, description, fmt::format("answer {}", answers.size() + 1)));
  }
}

CaseRecord read_record(const json& message, std::uint64_t id) {
  if (read_type(message) != "record") {
    throw ProtocolError(fmt::format("answered \"record\" with a message of the type {}",
                                    quote(read_type(message))));
  }
  check_id(message, id);
  CaseRecord record;
  if (const auto abscissa = message.find("abscissa"); abscissa != message.end()) {
    record.abscissa = read_quantity_of(*abscissa, "an abscissa");
    record.abscissa_values = read_points(*abscissa, "an abscissa");
  }
  for (const json& one : get_list(message, "series", kMostSeries)) {
    const Quantity quantity = read_quantity_of(one, "a signal");
    const std::string where = fmt::format("the signal '{}'", quantity.name);
    record.series.push_back({quantity, read_points(one, where)});
    if (record.series.back().values.size() != record.abscissa_values.size()) {
      throw ProtocolError(fmt::format("sent {} with {} values; the abscissa has {}", where,
                                      record.series.back().values.size(),
                                      record.abscissa_values.size()));
    }
  }
  for (const json& one : get_list(message, "files", kMostRecordFiles)) {
    const std::string name = read_name(one, "a file");
    const std::string where = fmt::format("the file '{}'", name);
    record.files.push_back({name, read_content(one, where)});
  }
  return record;
}

}  // namespace armwright
