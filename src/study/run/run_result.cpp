#include "study/run/run_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr int kResultFormat = 2;

json errors_to_json(const std::vector<double>& errors) {
  json list = json::array();
  for (const double error : errors) {
    list.push_back(std::isnan(error) ? json(nullptr) : json(error));
  }
  return list;
}

json quantity_to_json(const Quantity& quantity) {
  return {{"name", quantity.name}, {"unit", quantity.unit}};
}

Quantity quantity_from_json(const json& j) {
  return {j.at("name"), j.at("unit")};
}

json requirement_to_json(const RunResult& result, const RequiredMetric& requirement) {
  return {{"metric", result.metric_names.at(requirement.metric)},
          {"name", requirement.limit.quantity.name},
          {"unit", requirement.limit.quantity.unit},
          {"limit", requirement.limit.value},
          {"use", requirement.is_constraint ? "constraint" : "report"}};
}

RequiredMetric requirement_from_json(const RunResult& result, const json& j) {
  const auto found = std::ranges::find(result.metric_names, j.at("metric").get<std::string>());
  if (found == result.metric_names.end()) {
    throw std::runtime_error("a requirement is of a metric that it does not name");
  }
  RequiredMetric requirement;
  requirement.metric = static_cast<std::size_t>(found - result.metric_names.begin());
  requirement.limit = {quantity_from_json(j), j.at("limit")};
  requirement.is_constraint = j.at("use") == "constraint";
  if (!(requirement.limit.value > 0)) {
    throw std::runtime_error("a requirement's limit is not above 0");
  }
  return requirement;
}

json discrete_to_json(const DecisionVariable& variable) {
  json j = {{"name", variable.name}, {"type", to_string(variable.type)}};
  if (variable.type == VariableType::category) {
    j["choices"] = variable.choices;
  }
  return j;
}

DecisionVariable discrete_from_json(const RunResult& result, const json& j) {
  DecisionVariable variable{.name = j.at("name"), .unit = {}};
  if (std::ranges::count(result.variable_names, variable.name) == 0) {
    throw std::runtime_error("a discrete variable is none of its variables");
  }
  const std::string type = j.at("type");
  if (type == to_string(VariableType::category)) {
    variable.type = VariableType::category;
    variable.choices = j.at("choices").get<std::vector<std::string>>();
    if (variable.choices.empty()) {
      throw std::runtime_error("a category has no words");
    }
    variable.upper = static_cast<double>(variable.choices.size() - 1);
  } else if (type == to_string(VariableType::integer)) {
    variable.type = VariableType::integer;
  } else {
    throw std::runtime_error("a discrete variable has an unknown type");
  }
  return variable;
}

json evaluation_to_json(const Evaluation& evaluation) {
  return {{"feasible", is_proven_feasible(evaluation)},
          {"status", to_string(evaluation.status)},
          {"reason", evaluation.reason},
          {"objectives", evaluation.objectives},
          {"constraint_values", evaluation.constraint_values},
          {"metrics", evaluation.metrics},
          {"failed_cases", evaluation.failed_cases},
          {"case_errors", errors_to_json(evaluation.case_errors)}};
}

EvaluationStatus parse_status(const std::string& text) {
  for (const auto status :
       {EvaluationStatus::ok, EvaluationStatus::diverged, EvaluationStatus::unreachable,
        EvaluationStatus::timed_out, EvaluationStatus::failed, EvaluationStatus::abandoned}) {
    if (text == to_string(status)) {
      return status;
    }
  }
  throw std::runtime_error("unknown status '" + text + "'");
}

Evaluation evaluation_from_json(const json& j) {
  Evaluation evaluation;
  evaluation.status = parse_status(j.at("status"));
  evaluation.reason = j.at("reason");
  evaluation.objectives = j.at("objectives").get<std::vector<double>>();
  evaluation.constraint_values = j.at("constraint_values").get<std::vector<double>>();
  evaluation.metrics = j.at("metrics").get<std::vector<double>>();
  evaluation.failed_cases = whole_from_json<int>(j.at("failed_cases"));
  for (const json& error : j.at("case_errors")) {
    evaluation.case_errors.push_back(error.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                                     : error.get<double>());
  }
  return evaluation;
}

json candidate_to_json(const JudgedCandidate& judged) {
  const Candidate& candidate = judged.candidate;
  json j = {{"x", candidate.x},
            {"generation", candidate.generation},
            {"validation", evaluation_to_json(judged.validation)}};
  if (judged.further_cases > 0) {
    j["further_cases"] = judged.further_cases;
    j["further_failures"] = judged.further_failures;
  }
  if (candidate.recommended) {
    j["recommended"] = true;
  } else {
    j["evaluation"] = candidate.evaluation;
    j["training_objective"] = candidate.training_objective;
  }
  return j;
}

JudgedCandidate candidate_from_json(const json& j) {
  JudgedCandidate judged;
  judged.candidate.x = j.at("x").get<std::vector<double>>();
  judged.candidate.generation = whole_from_json(j.at("generation"));
  judged.candidate.recommended = j.value("recommended", false);
  if (!judged.candidate.recommended) {
    judged.candidate.evaluation = whole_from_json(j.at("evaluation"));
    judged.candidate.training_objective = j.at("training_objective");
  }
  judged.validation = evaluation_from_json(j.at("validation"));
  if (j.contains("further_cases")) {
    judged.further_cases = whole_from_json(j.at("further_cases"));
    judged.further_failures = whole_from_json(j.at("further_failures"));
  }
  return judged;
}

// Readers of a result use its lists side by side, so their lengths must agree.
void check_sizes(const RunResult& result, const Evaluation& evaluation) {
  const auto check = [](std::string_view what, std::size_t found, std::size_t named) {
    if (found != 0 && found != named) {
      throw std::runtime_error(
          fmt::format("an evaluation has {} {}, and {} are named", found, what, named));
    }
  };
  check("objectives", evaluation.objectives.size(), result.objectives.size());
  check("metrics", evaluation.metrics.size(), result.metric_names.size());
  if (!result.constraints.empty()) {
    check("constraint values", evaluation.constraint_values.size(), result.constraints.size());
  }
}

void check_sizes(const RunResult& result) {
  if (!result.objective_weights.empty() &&
      result.objective_weights.size() != result.objectives.size()) {
    throw std::runtime_error(fmt::format("it has {} objectives and weights for {}",
                                         result.objectives.size(),
                                         result.objective_weights.size()));
  }
  for (const JudgedCandidate& judged : result.judged) {
    if (judged.candidate.x.size() != result.variable_names.size()) {
      throw std::runtime_error(fmt::format("a candidate has {} values for {} variables",
                                           judged.candidate.x.size(),
                                           result.variable_names.size()));
    }
    check_sizes(result, judged.validation);
  }
  check_sizes(result, result.test);
  if (result.start) {
    check_sizes(result, result.start->test);
  }
}

}  // namespace

void RunCounts::add(const EvaluationRecord& record) {
  const EvaluationStatus status = record.evaluation.status;
  const bool is_abandoned = status == EvaluationStatus::abandoned;
  ++evaluations;
  cases += record.calc_charge();
  clipped += record.clipped ? 1 : 0;
  abandoned += is_abandoned ? 1 : 0;
  failed += status == EvaluationStatus::ok || is_abandoned ? 0 : 1;
  feasible += is_feasible(record.evaluation) ? 1 : 0;
}

std::string shorten_optimizer(const std::string& optimizer) {
  constexpr std::string_view kMultistart = "multistart:";
  const std::size_t begin = optimizer.starts_with(kMultistart) ? kMultistart.size() : 0;
  const std::size_t slash = optimizer.rfind('/');
  return slash == std::string::npos || slash < begin
             ? optimizer
             : optimizer.substr(0, begin) + optimizer.substr(slash + 1);
}

const DecisionVariable* find_discrete(const RunResult& result, std::size_t variable) {
  const auto found = std::ranges::find(result.discrete_variables,
                                       result.variable_names.at(variable), &DecisionVariable::name);
  return found == result.discrete_variables.end() ? nullptr : &*found;
}

double get_failure_error(const RunResult& result) {
  return result.tracking ? kFailureError_m : std::numeric_limits<double>::infinity();
}

namespace {

ErrorSummary summarize_start(const RunResult& result) {
  return summarize(result.start->test.case_errors, get_failure_error(result));
}

}  // namespace

std::vector<std::string> list_violated(const RunResult& result) {
  std::vector<std::string> names;
  if (!result.winner) {
    return names;
  }
  const std::vector<double>& values = result.test.constraint_values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] <= 0) {
      continue;
    }
    if (i < result.limits.size()) {
      names.push_back("the limit of " + sanitize(result.limits[i].quantity.name));
    } else {  // the file of a result may lack the names
      names.push_back(i < result.constraints.size() ? sanitize(result.constraints[i].name)
                                                    : fmt::format("constraint {}", i + 1));
    }
  }
  return names;
}

std::vector<std::string> list_faults(const RunResult& result) {
  std::vector<std::string> faults;
  if (!result.winner) {
    return faults;
  }
  const ErrorSummary& winner = result.test_summary;
  std::string start;
  if (result.start) {
    start = fmt::format(" (the start: {})", summarize_start(result).failures);
  }
  if (winner.failures > 0) {
    faults.push_back(fmt::format("the winner fails {} of {} test cases{}", winner.failures,
                                 winner.cases, start));
  }
  if (const auto violated = list_violated(result); !violated.empty()) {
    faults.push_back("on the test set the winner violates " + join(violated, ", "));
  }
  if (result.start && !result.start->is_worse_than_winner) {
    faults.emplace_back("no design better than the start was found");
  }
  return faults;
}

EffortTotals get_effort_totals(const RunResult& result) {
  if (result.sliding_efforts.force_n) {
    return result.sliding_efforts;
  }
  const auto torque = std::ranges::find(result.metric_names, "total_torque");
  const auto at = static_cast<std::size_t>(torque - result.metric_names.begin());
  EffortTotals totals;
  if (at < result.test.metrics.size()) {
    totals.torque_n_m = result.test.metrics[at];
  }
  return totals;
}

bool is_proven_feasible(const Evaluation& evaluation) {
  return is_feasible(evaluation) && evaluation.failed_cases == 0;
}

Quantity get_target(const RunResult& result) {
  return get_scalar_quantity(result.objectives);
}

double calc_target(const RunResult& result, const Evaluation& evaluation) {
  return calc_scalar(result.objective_weights, evaluation.objectives);
}

std::string to_json(const RunResult& result) {
  json objectives = json::array();
  std::ranges::transform(result.objectives, std::back_inserter(objectives), quantity_to_json);
  json constraints = json::array();
  for (std::size_t i = 0; i < result.constraints.size(); ++i) {
    constraints.push_back(quantity_to_json(result.constraints[i]));
    if (!result.limits.empty()) {
      const Limit& limit = result.limits[i];
      constraints.back()["limit"] = quantity_to_json(limit.quantity);
      constraints.back()["limit"]["value"] = limit.value;
    }
  }
  json judged = json::array();
  for (const JudgedCandidate& candidate : result.judged) {
    judged.push_back(candidate_to_json(candidate));
  }
  json j = {
      {"format", kResultFormat},
      {"problem", result.problem},
      {"optimizer", result.optimizer},
      {"seed", result.seed},
      {"tracking", result.tracking},
      {"end_reason", result.end_reason},
      {"failure", result.failure},
      {"first_failure", result.first_failure},
      {"counts",
       {{"evaluations", result.counts.evaluations},
        {"cases", result.counts.cases},
        {"clipped", result.counts.clipped},
        {"failed", result.counts.failed},
        {"feasible", result.counts.feasible},
        {"generations", result.counts.generations}}},
      {"variables", result.variable_names},
      {"metrics", result.metric_names},
      {"objectives", objectives},
      {"objective_weights", result.objective_weights},
      {"constraints", constraints},
      {"least_violation", optional_to_json(result.least_violation)},
      {"candidates", judged},
      {"winner", nullptr},
      {"test_set", result.test_set},
      {"published",
       {{"error_m", optional_to_json(result.published.error_m)},
        {"total_torque_n_m", optional_to_json(result.published.total_torque_n_m)},
        {"design", result.published.design},
        {"where", result.published.where}}},
  };
  if (result.counts.abandoned > 0) {  // as in results from versions without racing
    j["counts"]["abandoned"] = result.counts.abandoned;
  }
  if (!result.published.difference.empty()) {
    j["published"]["difference"] = result.published.difference;
  }
  if (!result.choice.empty()) {
    j["choice"] = result.choice;
  }
  if (!result.end_detail.empty()) {
    j["end_detail"] = result.end_detail;
  }
  if (result.unused_evaluations > 0) {
    j["unused_evaluations"] = result.unused_evaluations;
  }
  for (const RequiredMetric& requirement :
       result.requirements) {  // the key is left out if there are none
    j["requirements"].push_back(requirement_to_json(result, requirement));
  }
  for (const DecisionVariable& variable : result.discrete_variables) {  // left out if all are real
    j["discrete_variables"].push_back(discrete_to_json(variable));
  }
  if (result.winner) {
    j["winner"] = {{"candidate", *result.winner},
                   {"test", evaluation_to_json(result.test)},
                   {"test_summary", summary_to_json(result.test_summary)}};
    const std::vector<std::string> faults = list_faults(result);
    if (result.start || !faults.empty()) {  // a comparison's cell is not held against the start
      j["winner"]["faults"] = faults;
    }
    if (result.start) {
      j["start"] = {{"test", evaluation_to_json(result.start->test)},
                    {"test_summary", summary_to_json(summarize_start(result))},
                    {"is_worse_than_winner", result.start->is_worse_than_winner}};
    }
    if (result.test_motion) {
      j["winner"]["test_motion"] = motion_to_json(*result.test_motion);
    }
    if (result.sliding_efforts.force_n) {
      j["winner"]["efforts"] = efforts_to_json(result.sliding_efforts);
    }
  }
  return j.dump(1) + "\n";
}

RunResult parse_result(const std::string& text, const std::filesystem::path& file) {
  check_json_depth(text, file.string());
  try {
    const json j = json::parse(text);
    if (j.at("format") != kResultFormat) {
      throw std::runtime_error("its format is not the one this version reads");
    }
    RunResult result;
    result.problem = j.at("problem");
    result.optimizer = j.at("optimizer");
    result.seed = whole_from_json(j.at("seed"));
    result.tracking = j.at("tracking");
    result.end_reason = j.at("end_reason");
    result.choice = j.value("choice", std::string());
    result.end_detail = j.value("end_detail", std::string());
    result.unused_evaluations =
        whole_from_json<std::int64_t>(j.value("unused_evaluations", json(0U)));
    result.failure = j.at("failure");
    result.first_failure = j.at("first_failure");
    const json& counts = j.at("counts");
    result.counts.evaluations = whole_from_json(counts.at("evaluations"));
    result.counts.cases = whole_from_json(counts.at("cases"));
    result.counts.clipped = whole_from_json(counts.at("clipped"));
    result.counts.failed = whole_from_json(counts.at("failed"));
    result.counts.abandoned = whole_from_json(counts.value("abandoned", json(0U)));
    result.counts.feasible = whole_from_json(counts.at("feasible"));
    result.counts.generations = whole_from_json(counts.at("generations"));
    result.variable_names = j.at("variables").get<std::vector<std::string>>();
    for (const json& variable : j.value("discrete_variables", json::array())) {
      result.discrete_variables.push_back(discrete_from_json(result, variable));
    }
    result.metric_names = j.at("metrics").get<std::vector<std::string>>();
    for (const json& objective : j.at("objectives")) {
      result.objectives.push_back(quantity_from_json(objective));
    }
    // Results of earlier versions have neither constraints nor the least violation.
    for (const json& constraint : j.value("constraints", json::array())) {
      result.constraints.push_back(quantity_from_json(constraint));
      if (constraint.contains("limit")) {
        const json& limit = constraint["limit"];
        result.limits.push_back({quantity_from_json(limit), limit.at("value")});
      }
    }
    if (!result.limits.empty() && result.limits.size() != result.constraints.size()) {
      throw std::runtime_error("some of its constraints have a limit and others none");
    }
    for (const json& requirement : j.value("requirements", json::array())) {
      result.requirements.push_back(requirement_from_json(result, requirement));
    }
    result.least_violation = optional_from_json(j.value("least_violation", json(nullptr)));
    if (result.objectives.empty()) {
      throw std::runtime_error("it names no objective");
    }
    result.objective_weights = j.at("objective_weights").get<std::vector<double>>();
    for (const json& candidate : j.at("candidates")) {
      result.judged.push_back(candidate_from_json(candidate));
    }
    result.test_set = j.at("test_set");
    const json& published = j.at("published");
    result.published.error_m = optional_from_json(published.at("error_m"));
    result.published.total_torque_n_m = optional_from_json(published.at("total_torque_n_m"));
    result.published.design = published.at("design");
    result.published.where = published.at("where");
    result.published.difference = published.value("difference", std::string());
    if (!j.at("winner").is_null()) {
      result.winner = whole_from_json<std::size_t>(j.at("winner").at("candidate"));
      if (*result.winner >= result.judged.size()) {
        throw std::runtime_error("its winner is not among its candidates");
      }
      result.test = evaluation_from_json(j.at("winner").at("test"));
      result.test_summary = summarize(result.test.case_errors, get_failure_error(result));
      if (j.contains("start")) {
        result.start = JudgedStart{.test = evaluation_from_json(j["start"].at("test")),
                                   .is_worse_than_winner = j["start"].at("is_worse_than_winner")};
      }
      if (j.at("winner").contains("test_motion")) {
        result.test_motion = motion_from_json(j["winner"]["test_motion"]);
      }
      if (j.at("winner").contains("efforts")) {
        const json& efforts = j["winner"]["efforts"];
        result.sliding_efforts = {.torque_n_m = optional_from_json(efforts.at("total_torque_n_m")),
                                  .force_n = optional_from_json(efforts.at("total_force_n"))};
      }
    }
    check_sizes(result);
    return result;
  } catch (const std::exception& error) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: is not a result that armwright wrote ({}). To rebuild it from an "
                    "intact journal, remove it and give the command that began the run again",
                    file.string(), describe_json_error(error.what())));
  }
}

}  // namespace armwright
