#include "study/compare/study_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// How training goes. With what kind of controller the designs have, kController, that is a
// method's; all else is what is asked of a design. So is the rest of [control]: the plant is
// integrated in steps of the control period.
constexpr const char* kMethodTables[] = {"racing", "schedule", "perturbation"};
constexpr std::string_view kController = "control.controller";

std::string get_table(std::string_view setting) {
  return std::string(setting.substr(0, setting.find_first_of(".=")));
}

std::string get_key(std::string_view setting) {
  const std::string_view key = setting.substr(0, setting.find('='));
  return std::string(key.substr(0, key.find_last_not_of(' ') + 1));
}

// The perturbation that designs meet in validation and tests; nothing if there is none, whatever
// its table says.
std::optional<Perturbation> get_judged_perturbation(const LoadedProblem& problem) {
  if (!problem.tracking() ||
      !problem.tracking()->config().perturbation.applies_to(CaseRole::test)) {
    return {};
  }
  Perturbation perturbation = problem.tracking()->config().perturbation;
  perturbation.where = Perturbation::Where::judging;  // whether training has it as well
  return perturbation;
}

// The configuration without what may be a method's own.
json leave_method_out(const LoadedProblem& problem) {
  json resolved = json::parse(problem.resolved_json);
  for (const char* table : kMethodTables) {
    resolved.erase(table);
  }
  if (const auto control = resolved.find("control"); control != resolved.end()) {
    control->erase("controller");
    if (control->empty()) {
      resolved.erase(control);
    }
  }
  return resolved;
}

LoadedProblem load_method(const StudyProblem& problem, const StudyOptimizer& optimizer) {
  std::vector<std::string> settings = problem.settings;
  settings.insert(settings.end(), optimizer.settings.begin(), optimizer.settings.end());
  // The level that the problem was settled on, which may be the recorded one.
  const json resolved = json::parse(problem.loaded.resolved_json);
  if (resolved.contains("physics") && resolved["physics"].contains("simd")) {
    settings.push_back("physics.simd=" + resolved["physics"]["simd"].get<std::string>());
  }
  LoadedProblem loaded = load_problem(problem.name, settings);
  if (get_judged_perturbation(loaded) != get_judged_perturbation(problem.loaded)) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer {} on {}: its designs would be judged on other plants than "
                            "those of the others; a perturbation of its own must have "
                            "perturbation.apply_to=training",
                            optimizer.label, problem.label));
  }
  if (leave_method_out(loaded) != leave_method_out(problem.loaded)) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer {} on {}: its settings change what is asked of a design",
                            optimizer.label, problem.label));
  }
  return loaded;
}

}  // namespace

std::vector<std::string> read_method_settings(const ConfigTable& optimizer) {
  if (!optimizer.has("set")) {
    return {};
  }
  const std::vector<std::string> settings = optimizer.get_strings("set");
  for (const std::string& setting : settings) {
    const std::string key = get_key(setting);
    if (key != kController &&
        std::ranges::find(kMethodTables, get_table(setting)) == std::end(kMethodTables)) {
      optimizer.refuse(
          "set",
          fmt::format("{} is the same for every optimizer of a comparison. Of an optimizer's "
                      "own may be how its budget is spent in training and what controls its "
                      "designs: schedule = \"KIND:K\", and in `set` racing.*, schedule.*, "
                      "perturbation.* and {}",
                      sanitize(key), kController));
    }
    if (key == "schedule.kind" || key == "schedule.cases" || key == "schedule.fixed_cases") {
      optimizer.refuse("set", fmt::format("for {} write schedule = \"KIND:K\"", key));
    }
  }
  return settings;
}

void load_methods(StudyPlan& plan) {
  for (StudyOptimizer& optimizer : plan.optimizers) {
    for (const StudyProblem& problem : plan.problems) {
      if (!optimizer.settings.empty()) {
        optimizer.loaded.insert_or_assign(problem.label, load_method(problem, optimizer));
      }
    }
  }
}

void read_targets(const ConfigTable& table, StudyPlan& plan) {
  constexpr std::int64_t kMostFailures = 1'000'000;
  const std::vector<std::string> values = {"objective", "failures"};
  plan.value = table.get_choice("value", values, "objective") == "failures" ? StudyValue::failures
                                                                            : StudyValue::objective;
  plan.reference = table.get_string("reference", "");
  for (const ConfigTable& one : table.get_tables_or_empty("target")) {
    StudyTarget target;
    target.label = one.get_string("label");
    if (one.has("problems")) {
      target.problems = one.get_strings("problems");
    }
    if (one.has("value")) {
      target.value = one.get_number("value");
    }
    if (one.has("failures")) {
      target.failures = one.get_integer("failures", 0, kMostFailures);
    }
    if (!target.value && !target.failures) {
      one.refuse("label",
                 "it must have a value (the objective on the test set at most), failures (the most "
                 "test cases with an error above 100 mm), or both");
    }
    plan.targets.push_back(std::move(target));
  }
}

void check_targets(StudyPlan& plan) {
  std::vector<std::string> problems;
  for (const StudyProblem& problem : plan.problems) {
    problems.push_back(problem.label);
  }
  std::vector<std::string> labels;
  for (StudyTarget& target : plan.targets) {
    if (target.label.empty() || sanitize(target.label) != target.label) {
      throw Error(ErrorKind::usage,
                  fmt::format("target label '{}' is not printable text", sanitize(target.label)));
    }
    if (std::ranges::find(labels, target.label) != labels.end()) {
      throw Error(ErrorKind::usage,
                  fmt::format("two targets of the study are called '{}'; give one of them another "
                              "label",
                              target.label));
    }
    labels.push_back(target.label);
    if (target.problems.empty()) {
      target.problems = problems;
    }
    for (const std::string& problem : target.problems) {
      const auto found = std::ranges::find(plan.problems, problem, &StudyProblem::label);
      if (found == plan.problems.end()) {
        throw Error(ErrorKind::usage, fmt::format("target '{}': {}", target.label,
                                                  describe_unknown("problem", problem, problems)));
      }
      if (target.failures && !found->loaded.tracking()) {
        throw Error(ErrorKind::usage,
                    fmt::format("target '{}' counts failing test cases, and {} is a function, "
                                "which has none",
                                target.label, problem));
      }
    }
  }
  if (plan.value == StudyValue::failures) {
    for (const StudyProblem& problem : plan.problems) {
      if (!problem.loaded.tracking() ||
          problem.loaded.problem->description().objectives.size() > 1) {
        throw Error(ErrorKind::usage,
                    fmt::format("value is \"failures\": that compares arms by the share of test "
                                "cases in which they fail, and {} is {}",
                                problem.label,
                                problem.loaded.tracking() ? "judged by its front" : "a function"));
      }
    }
  }
  if (plan.reference.empty()) {
    return;
  }
  std::vector<std::string> optimizers;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    optimizers.push_back(optimizer.label);
  }
  if (std::ranges::find(optimizers, plan.reference) == optimizers.end()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("reference: {}", describe_unknown("optimizer", plan.reference, optimizers)));
  }
  if (plan.targets.empty()) {
    throw Error(ErrorKind::usage,
                "reference names an optimizer whose expected running times to targets those of the "
                "others are divided by, and the study has no [[target]]");
  }
}

}  // namespace armwright
