#include "problems/user/native_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/base64.hpp"
#include "base/text.hpp"
#include "problems/user/case_messages.hpp"
#include "process/json_message.hpp"

namespace armwright {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::size_t kLongestNativeText = 1000;
constexpr std::size_t kMostNativeEntries =
    10000;                                      // of one list; read_user_description() allows fewer
constexpr std::size_t kMostNativeWords = 1000;  // as there
// The size of the struct in the first version of the interface.
constexpr std::size_t kFirstProblemSize = sizeof(struct armwright_user_problem);

std::string take_native_text(const char* text, const std::string& what) {
  if (text == nullptr) {
    return "";
  }
  if (strnlen(text, kLongestNativeText + 1) > kLongestNativeText) {
    throw ProtocolError(fmt::format("sent a description whose {} has more than {} bytes", what,
                                    kLongestNativeText));
  }
  return text;
}

[[noreturn]] void refuse_native(const std::string& field, const std::string& fault) {
  throw ProtocolError(fmt::format("sent a description whose {} {}", field, fault));
}

// Calls `take` with each entry of a list and its name: "variables[2]".
template <class Entry, class Take>
void take_list(const Entry* list, std::size_t count, const char* name, Take take) {
  if (count > kMostNativeEntries) {
    refuse_native(name, fmt::format("are {} by their count; at most {} are possible", count,
                                    kMostNativeEntries));
  }
  if (count > 0 && list == nullptr) {
    refuse_native(name, fmt::format("are NULL, and their count is {}", count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    take(list[i], fmt::format("{}[{}]", name, i));
  }
}

void take_native_category(const armwright_variable& raw, const std::string& where,
                          DecisionVariable& variable) {
  for (std::size_t i = 0; raw.choices != nullptr && raw.choices[i] != nullptr; ++i) {
    if (i == kMostNativeWords) {
      refuse_native(where + ".choices",
                    fmt::format("do not end with NULL after {} words", kMostNativeWords));
    }
    variable.choices.push_back(take_native_text(raw.choices[i], where + ".choices"));
  }
  variable.upper = static_cast<double>(variable.choices.size()) - 1;
  variable.start = std::isnan(raw.start) ? 0 : raw.start;
  const bool is_place = variable.start == std::floor(variable.start) && variable.start >= 0 &&
                        variable.start <= variable.upper;
  if (!is_place && variable.choices.size() > 1) {  // fewer words are refused later
    refuse_native(where + ".start",
                  fmt::format("is {}; it must be the place of a word, from 0 to {}",
                              format_exact(raw.start), variable.upper));
  }
}

DecisionVariable take_native_variable(const armwright_variable& raw, const std::string& where) {
  static_assert(ARMWRIGHT_VARIABLE_REAL == 0 && ARMWRIGHT_VARIABLE_INTEGER == 1 &&
                ARMWRIGHT_VARIABLE_CATEGORY == 2);
  DecisionVariable variable;
  variable.name = take_native_text(raw.name, where + ".name");
  variable.unit = take_native_text(raw.unit, where + ".unit");
  if (raw.type < 0 || raw.type >= static_cast<std::int32_t>(kVariableTypes.size())) {
    refuse_native(
        where + ".type",
        fmt::format("is {}; possible are 0 (real), 1 (integer) and 2 (category)", raw.type));
  }
  variable.type = kVariableTypes[static_cast<std::size_t>(raw.type)];
  if (variable.type == VariableType::category) {
    take_native_category(raw, where, variable);
    return variable;
  }
  for (const auto& [key, value] : {std::pair{"lower", raw.lower}, {"upper", raw.upper}}) {
    if (!std::isfinite(value)) {
      refuse_native(fmt::format("{}.{}", where, key),
                    fmt::format("is {}; it must be a finite number", value));
    }
  }
  variable.lower = raw.lower;
  variable.upper = raw.upper;
  variable.scale = raw.is_logarithmic != 0 ? Scale::logarithmic : Scale::linear;
  variable.start = raw.start;
  if (std::isnan(raw.start)) {
    variable.start = raw.lower <= raw.upper ? choose_start(variable) : raw.lower;
  }
  return variable;
}

std::int64_t take_count(std::int64_t count, const char* name) {
  if (count < ARMWRIGHT_ANY_CASES) {
    refuse_native(
        name, fmt::format("is {}; it must be a number of cases, or ARMWRIGHT_ANY_CASES", count));
  }
  return count == 0 ? 1 : std::max<std::int64_t>(count, 0);
}

std::optional<double> take_number(const double* number) {
  return number == nullptr ? std::nullopt : std::optional(*number);
}

// Collects what a problem records as the message "record". Its functions are the fields of
// armwright_record.
class RecordWriter {
 public:
  explicit RecordWriter(std::uint64_t id)
      : message_{{"type", "record"},
                 {"id", id},
                 {"series", OrderedJson::array()},
                 {"files", OrderedJson::array()}} {}

  armwright_record make_border() {
    return {
        .struct_size = sizeof(armwright_record),
        .context = this,
        .set_abscissa =
            [](armwright_record* record, const char* name, const char* unit, const double* values,
               std::size_t count) {
              get(record)["abscissa"] = make_signal(name, unit, values, count);
            },
        .add_series =
            [](armwright_record* record, const char* name, const char* unit, const double* values,
               std::size_t count) {
              get(record)["series"].push_back(make_signal(name, unit, values, count));
            },
        .add_file =
            [](armwright_record* record, const char* name, const void* bytes, std::size_t size) {
              get(record)["files"].push_back(
                  {{"name", name == nullptr ? "" : name},
                   {"base64", to_base64({static_cast<const std::uint8_t*>(bytes), size})}});
            }};
  }

  std::string text() const {
    return message_.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  }

 private:
  static OrderedJson& get(armwright_record* record) {
    return static_cast<RecordWriter*>(record->context)->message_;
  }
  static OrderedJson make_signal(const char* name, const char* unit, const double* values,
                                 std::size_t count) {
    return {{"name", name == nullptr ? "" : name},
            {"unit", unit == nullptr ? "" : unit},
            {"values", std::vector<double>(values, values + count)}};
  }

  OrderedJson message_;
};

class NativeServer final : public CaseServer {
 public:
  NativeServer(const struct armwright_user_problem& problem, UserDescription description)
      : caller_(problem), description_(std::move(description)) {}

  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    while (!jobs.empty()) {
      const auto some = jobs.first(std::min(jobs.size(), NativeCaller::kMostQuestions));
      std::vector<armwright_case> questions;
      for (const CaseJob& job : some) {
        questions.push_back(make_native_question(description_, job));
      }
      caller_.ask(questions, [](std::size_t) {});
      for (std::size_t i = 0; i < some.size(); ++i) {
        const NativeCaller::Answer one = caller_.answer(i);
        answers.push_back(make_answer(description_, one.status,
                                      {one.reason, strnlen(one.reason, kLongestNativeText)},
                                      one.numbers, one.residuals));
      }
      jobs = jobs.subspan(some.size());
    }
  }

  CaseRecord record(const CaseJob& job) override {
    return read_record(read_message(caller_.record(make_native_question(description_, job), 0)), 0);
  }

 private:
  NativeCaller caller_;
  UserDescription description_;
};

}  // namespace

struct armwright_user_problem read_native_problem(const struct armwright_user_problem* raw) {
  if (raw == nullptr) {
    throw ProtocolError("describes nothing: armwright_user_problem() returned NULL");
  }
  if (raw->abi != ARMWRIGHT_PROBLEM_ABI) {
    throw ProtocolError(
        fmt::format("is built for version {} of the interface of problems, and this armwright has "
                    "version {}; build it against this armwright's armwright/problem.h",
                    raw->abi, ARMWRIGHT_PROBLEM_ABI));
  }
  if (raw->struct_size < kFirstProblemSize) {
    throw ProtocolError(
        fmt::format("says that its struct armwright_user_problem has {} bytes; it has {} or more",
                    raw->struct_size, kFirstProblemSize));
  }
  if (raw->evaluate == nullptr) {
    throw ProtocolError("has no function evaluate: it is NULL");
  }
  struct armwright_user_problem problem {};
  std::memcpy(&problem, raw, std::min(raw->struct_size, sizeof problem));
  return problem;
}

UserDescription describe_native_problem(const struct armwright_user_problem& problem) {
  UserDescription made;
  made.name = take_native_text(problem.name, "name");
  made.summary = take_native_text(problem.summary, "summary");
  take_list(problem.variables, problem.variable_count, "variables",
            [&](const armwright_variable& one, const std::string& where) {
              made.variables.push_back(take_native_variable(one, where));
            });
  const auto take_quantity = [](const auto& one, const std::string& where) {
    return Quantity{take_native_text(one.name, where + ".name"),
                    take_native_text(one.unit, where + ".unit")};
  };
  take_list(problem.objectives, problem.objective_count, "objectives",
            [&](const armwright_objective& one, const std::string& where) {
              made.objectives.push_back({.quantity = take_quantity(one, where),
                                         .is_maximised = one.is_maximised != 0,
                                         .weight = one.weight == 0 ? 1 : one.weight,
                                         .penalty = take_number(one.penalty),
                                         .bound = take_number(one.bound)});
            });
  take_list(
      problem.constraints, problem.constraint_count, "constraints",
      [&](const armwright_constraint& one, const std::string& where) {
        made.constraints.push_back(
            {take_quantity(one, where), one.limit == 0 ? std::nullopt : std::optional(one.limit)});
      });
  take_list(problem.metrics, problem.metric_count, "metrics",
            [&](const armwright_metric& one, const std::string& where) {
              made.metrics.push_back(take_quantity(one, where));
            });
  made.has_residuals = problem.has_residuals != 0;
  made.training_cases = take_count(problem.training_cases, "training_cases");
  made.validation_cases = take_count(problem.validation_cases, "validation_cases");
  made.test_cases = take_count(problem.test_cases, "test_cases");
  made.takes_worst_case = problem.takes_worst_case != 0;
  made.is_deterministic = problem.is_noisy == 0;
  made.has_records = problem.record != nullptr;
  return made;
}

NativeCaller::NativeCaller(const struct armwright_user_problem& problem)
    : problem_(problem),
      width_(problem.objective_count + problem.constraint_count + problem.metric_count) {}

void NativeCaller::ask(std::span<const armwright_case> questions,
                       const std::function<void(std::size_t answered)>& on_answered) {
  const std::size_t count = questions.size();
  numbers_.assign(count * width_, std::numeric_limits<double>::quiet_NaN());
  reasons_.resize(std::max(reasons_.size(), count * kReasonBytes));
  residuals_.resize(std::max(residuals_.size(), count));
  answers_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    double* const numbers = numbers_.data() + i * width_;
    reasons_[i * kReasonBytes] = '\0';
    residuals_[i].clear();
    answers_.push_back(
        {.struct_size = sizeof(armwright_answer),
         .context = &residuals_[i],
         .status = ARMWRIGHT_CASE_OK,
         .objectives = numbers,
         .constraints = numbers + problem_.objective_count,
         .metrics = numbers + problem_.objective_count + problem_.constraint_count,
         .reason = reasons_.data() + i * kReasonBytes,
         .reason_size = kReasonBytes,
         .set_residuals = [](armwright_answer* answer, const double* values, std::size_t size) {
           static_cast<std::vector<double>*>(answer->context)->assign(values, values + size);
         }});
  }
  if (problem_.evaluate_batch == nullptr) {
    for (std::size_t i = 0; i < count; ++i) {
      problem_.evaluate(problem_.context, &questions[i], &answers_[i]);
      on_answered(i + 1);
    }
    return;
  }
  std::vector<const armwright_case*> question_list;
  answer_list_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    question_list.push_back(&questions[i]);
    answer_list_.push_back(&answers_[i]);
  }
  problem_.evaluate_batch(problem_.context, question_list.data(), answer_list_.data(), count);
  on_answered(count);
}

NativeCaller::Answer NativeCaller::answer(std::size_t i) const {
  return {.status = answers_[i].status,
          .reason = reasons_.data() + i * kReasonBytes,
          .numbers = std::span(numbers_).subspan(i * width_, width_),
          .residuals = residuals_[i]};
}

std::string NativeCaller::record(const armwright_case& question, std::uint64_t id) const {
  RecordWriter writer(id);
  armwright_record border = writer.make_border();
  std::array<char, kReasonBytes> message{};
  if (problem_.record(problem_.context, &question, &border, message.data(), message.size()) != 0) {
    message.back() = '\0';
    throw ProtocolError(fmt::format("cannot record a case: {}", sanitize(message.data())));
  }
  return writer.text();
}

CaseAnswer make_answer(const UserDescription& description, std::int32_t status,
                       std::string_view reason, std::span<const double> numbers,
                       std::vector<double> residuals) {
  CaseAnswer answer;
  reason = reason.substr(0, std::min(reason.find('\0'), NativeCaller::kReasonBytes - 1));
  switch (status) {
    case ARMWRIGHT_CASE_OK: {
      const auto take = [&numbers](std::size_t count) {
        const std::span<const double> taken = numbers.first(count);
        numbers = numbers.subspan(count);
        return std::vector<double>(taken.begin(), taken.end());
      };
      answer.objectives = take(description.objectives.size());
      answer.constraints = take(description.constraints.size());
      answer.metrics = take(description.metrics.size());
      answer.residuals = std::move(residuals);
      return answer;
    }
    case ARMWRIGHT_CASE_DIVERGED:
      answer.status = EvaluationStatus::diverged;
      break;
    case ARMWRIGHT_CASE_UNREACHABLE:
      answer.status = EvaluationStatus::unreachable;
      break;
    case ARMWRIGHT_CASE_FAILED:
      answer.status = EvaluationStatus::failed;
      break;
    case ARMWRIGHT_CASE_BROKEN:
      throw ProtocolError(fmt::format("can compute no case: {}",
                                      reason.empty() ? "it gives no reason" : sanitize(reason)));
    default:
      throw ProtocolError(
          fmt::format("answered with the status {}; problem.h has the possible ones", status));
  }
  answer.reason = sanitize(reason);
  return answer;
}

armwright_case make_native_question(const UserDescription& description, const CaseJob& job) {
  static_assert(static_cast<int>(CaseRole::training) == 0 &&
                static_cast<int>(CaseRole::validation) == 1 &&
                static_cast<int>(CaseRole::test) == 2);
  return {.struct_size = sizeof(armwright_case),
          .x = job.x.data(),
          .number = job.number,
          .seed = calc_case_seed(*job.block, job.number),
          .set = job.block->set.c_str(),
          .role = static_cast<std::int32_t>(job.block->role),
          .wants_residuals = job.residuals && description.has_residuals ? 1 : 0};
}

std::unique_ptr<CaseServer> make_native_server(const struct armwright_user_problem& problem,
                                               UserDescription description) {
  return std::make_unique<NativeServer>(problem, std::move(description));
}

}  // namespace armwright
