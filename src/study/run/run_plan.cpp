#include "study/run/run_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/user/user_problem.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json to_json_value(const OptionValue& value) {
  return std::visit([](const auto& v) { return json(v); }, value);
}

// The candidates of a generation or batch are in memory together, each with its variables and the
// outcomes of its cases. Throws Error{usage} if that is too much.
void check_size(const RunPlan& plan) {
  constexpr std::int64_t kMostNumbers = 50'000'000;  // a few times 400 MB
  const auto each =
      static_cast<std::int64_t>(plan.problem.problem->description().variables.size()) +
      plan.schedule.cases;
  for (const char* name : {"population", "batch", "samples"}) {
    const auto option = plan.options.values().find(name);
    const auto* size = option == plan.options.values().end()
                           ? nullptr
                           : std::get_if<std::int64_t>(&option->second);
    if (size != nullptr && *size > kMostNumbers / each) {
      throw Error(
          ErrorKind::usage,
          fmt::format("optimizer '{}': option '{}' is {}; with {} variables and {} training "
                      "cases per candidate it must be at most {} to fit into memory",
                      plan.optimizer.name, name, *size, each - plan.schedule.cases,
                      plan.schedule.cases, kMostNumbers / each));
    }
  }
}

}  // namespace

bool takes_schedule(const OptimizerRow& optimizer, const Schedule& schedule) {
  const Capabilities& can = optimizer.capabilities;
  return !schedule.changes_cases() || can.generations ||
         (schedule.kind == Schedule::Kind::growing && can.growing);
}

Schedule choose_schedule(const LoadedProblem& problem, const OptimizerRow& optimizer) {
  if (!takes_schedule(optimizer, problem.schedule)) {
    return {.kind = Schedule::Kind::fixed, .cases = problem.fixed_cases};
  }
  return problem.schedule;
}

bool wants_residuals(const OptimizerRow& optimizer) {
  return optimizer.capabilities.residuals || optimizer.requirements.residuals;
}

bool can_race(const OptimizerRow& optimizer, Racing::Kind kind) {
  const Capabilities& can = optimizer.capabilities;
  const bool competes = can.generations || can.sampling;
  return kind != Racing::Kind::none && !wants_residuals(optimizer) &&
         (kind != Racing::Kind::halving || competes);
}

std::string explain_no_race(const OptimizerRow& optimizer, const Racing& racing,
                            const Schedule& schedule) {
  if (racing.kind == Racing::Kind::none) {
    return "";
  }
  if (!can_race(optimizer, racing.kind)) {
    return can_race(optimizer, Racing::Kind::abandonment)
               ? "candidates race within a generation or a sample, and there are none"
               : "least squares need the errors of all cases";
  }
  if (racing.kind == Racing::Kind::abandonment && racing.chunk_cases >= schedule.cases) {
    return fmt::format("chunks of {} leave nothing of {} to give up", racing.chunk_cases,
                       to_text(schedule));
  }
  return "";
}

void check_plan(const RunPlan& plan) {
  const OptimizerRow& row = plan.optimizer;
  const std::string unsuitable = explain_unsuitable(row, plan.problem.problem->description());
  if (!unsuitable.empty()) {
    throw Error(ErrorKind::usage, fmt::format("optimizer '{}' cannot work on {}: {}", row.name,
                                              plan.problem.name, unsuitable));
  }
  const std::int64_t evaluations = plan.budget / std::max(plan.schedule.cases, 1);
  if (row.limits.evaluations > 0 && evaluations > row.limits.evaluations) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}' is made for at most {} evaluations, and a budget of {} "
                            "with schedule {} has {}; use --budget {}, or --optimizer {}",
                            row.name, row.limits.evaluations, plan.budget, to_text(plan.schedule),
                            evaluations, row.limits.evaluations * plan.schedule.cases,
                            row.limits.alternative));
  }
  if (!takes_schedule(row, plan.schedule)) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}' has no generations, so training cases that change "
                            "between them (schedule {}) are not possible; use --schedule fixed:K, "
                            "which evaluates every candidate on the same K cases",
                            row.name, to_string(plan.schedule.kind)));
  }
  if (plan.schedule.kind == Schedule::Kind::coevolution && plan.schedule.cases < kFewestBredCases) {
    throw Error(ErrorKind::usage,
                fmt::format("schedule coevolution breeds {} training cases; there must be at least "
                            "{}, for parents and children",
                            plan.schedule.cases, kFewestBredCases));
  }
  const ProblemDescription& problem = plan.problem.problem->description();
  if (plan.schedule.kind == Schedule::Kind::coevolution &&
      find_user_description(*plan.problem.problem) != nullptr) {
    throw Error(ErrorKind::usage,
                fmt::format("schedule coevolution breeds the paths of a robot's tool, and {} has "
                            "cases of its own; use fixed:K or fresh:K",
                            plan.problem.name));
  }
  const std::int64_t available = plan.problem.sets.training_cases;
  if (available > 0 && (plan.schedule.cases > available ||
                        (plan.schedule.kind == Schedule::Kind::fresh && available > 1))) {
    throw Error(ErrorKind::usage,
                fmt::format("schedule {} needs more training cases than {} has, which are {}; use "
                            "fixed:K with K from 1 to {}",
                            to_text(plan.schedule), plan.problem.name, available, available));
  }
  if (plan.racing.kind != Racing::Kind::none &&
      (problem.objectives.size() > 1 || !problem.constraints.empty())) {
    throw Error(ErrorKind::usage,
                fmt::format("racing {} ranks candidates by one number, but {} has {}; use racing "
                            "none there, or one objective without limits",
                            to_string(plan.racing.kind), plan.problem.name,
                            problem.constraints.empty() ? "several objectives" : "constraints"));
  }
  if (plan.racing.kind == Racing::Kind::halving && plan.racing.first_cases >= plan.schedule.cases) {
    throw Error(
        ErrorKind::usage,
        fmt::format("racing {} gives every candidate {} to begin with, and schedule {} has "
                    "no more: there is no race. Use a schedule of more cases, fewer "
                    "racing.first_cases, or racing none",
                    to_text(plan.racing),
                    plan.racing.first_cases == 1 ? "1 case"
                                                 : fmt::format("{} cases", plan.racing.first_cases),
                    to_text(plan.schedule)));
  }
  if (plan.racing.kind == Racing::Kind::abandonment &&
      !plan.problem.problem->calc_lower_bound(std::vector<double>(problem.variables.size()), {},
                                              1)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("racing abandonment needs a lower bound of the objective, which {} does "
                    "not have; use racing halving or none",
                    plan.problem.name));
  }
  check_size(plan);
  if (plan.budget < 0) {
    throw Error(ErrorKind::usage, fmt::format("--budget is {}; it must be >= 0", plan.budget));
  }
}

std::string to_json(const RunPlan& plan) {
  json options = json::object();
  for (const auto& [name, value] : plan.options.values()) {
    if (is_recorded(plan.optimizer.options, name, value)) {
      options[name] = to_json_value(value);
    }
  }
  json run = {
      {"optimizer", plan.optimizer.name},
      {"options", options},
      {"seed", plan.seed},
      {"budget", plan.budget},
      {"schedule", {{"kind", to_string(plan.schedule.kind)}, {"cases", plan.schedule.cases}}},
      {"selection", {{"last", plan.selection.last}, {"best", plan.selection.best}}},
  };
  if (plan.schedule.kind == Schedule::Kind::growing) {
    run["schedule"]["factor"] = plan.schedule.factor;
  }
  if (plan.selection.most > 0) {  // absent in plans of version 1.0
    run["selection"]["most"] = plan.selection.most;
  }
  if (plan.selection.evaluated_only) {
    run["selection"]["evaluated_only"] = true;
  }
  if (plan.racing.kind != Racing::Kind::none) {  // as in plans from versions without racing
    run["racing"] = to_text(plan.racing);
  }
  std::map<std::string, std::string> inputs = plan.problem.input_hashes;
  inputs.insert(plan.optimizer.input_hashes.begin(), plan.optimizer.input_hashes.end());
  const json whole = {
      {"problem", json::parse(plan.problem.resolved_json)}, {"inputs", inputs}, {"run", run}};
  return whole.dump(2);
}

Schedule read_recorded_schedule(const json& schedule) {
  const auto kind = find_schedule_kind(schedule.at("kind").get<std::string>());
  return {.kind = kind.value_or(Schedule::Kind::fixed),
          .cases = schedule.at("cases").get<int>(),
          .factor = schedule.value("factor", Schedule{}.factor)};
}

std::string make_run_name(const RunPlan& plan) {
  std::string optimizer = plan.optimizer.name;
  for (char& c : optimizer) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_';
    c = plain ? c : '-';
  }
  // "./libmine.so" and "exec:python3 -u mine.py" must not give a hidden file or a path.
  optimizer.erase(0, optimizer.find_first_not_of("-."));
  return fmt::format("{}-{}-seed{}", plan.problem.name, optimizer, plan.seed);
}

}  // namespace armwright
