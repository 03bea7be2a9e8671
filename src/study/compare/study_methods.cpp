#include "study/compare/study_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Tables that define training. A method may change these tables and the kind of controller
// (kController). All other settings are requirements on a design. The rest of [control] is one too:
// the plant is integrated in steps of the control period.
constexpr const char* kMethodTables[] = {"racing", "schedule", "perturbation"};
constexpr std::string_view kController = "control.controller";

std::string get_table(std::string_view setting) {
  return std::string(setting.substr(0, setting.find_first_of(".=")));
}

std::string get_key(std::string_view setting) {
  const std::string_view key = setting.substr(0, setting.find('='));
  return std::string(key.substr(0, key.find_last_not_of(' ') + 1));
}

// Returns the perturbation of validation and test cases; nothing if these are not perturbed, even
// if the table has values.
std::optional<Perturbation> get_judged_perturbation(const LoadedProblem& problem) {
  if (!problem.tracking() ||
      !problem.tracking()->config().perturbation.applies_to(CaseRole::test)) {
    return {};
  }
  Perturbation perturbation = problem.tracking()->config().perturbation;
  perturbation.where = Perturbation::Where::judging;  // training may differ
  return perturbation;
}

// Returns the configuration without the settings that a method may change.
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

// Loads the problem with the optimizer's settings. An error names both.
LoadedProblem load_for_method(const StudyProblem& problem, const StudyOptimizer& optimizer,
                              const std::vector<std::string>& settings,
                              const ProgramSource& programs) {
  try {
    return load_problem(problem.name, settings, engine_table(), programs);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("optimizer {} on {}: {}", optimizer.label, problem.label,
                                          error.what()));
  }
}

LoadedProblem load_method(const StudyProblem& problem, const StudyOptimizer& optimizer,
                          const ProgramSource& programs) {
  std::vector<std::string> settings = problem.settings;
  settings.insert(settings.end(), optimizer.settings.begin(), optimizer.settings.end());
  // The SIMD level in use for the problem, which may be a recorded one.
  const json resolved = json::parse(problem.loaded.resolved_json);
  if (resolved.contains("physics") && resolved["physics"].contains("simd")) {
    settings.push_back("physics.simd=" + resolved["physics"]["simd"].get<std::string>());
  }
  std::ranges::move(list_proposals(resolved), std::back_inserter(settings));
  LoadedProblem loaded = load_for_method(problem, optimizer, settings, programs);
  if (get_judged_perturbation(loaded) != get_judged_perturbation(problem.loaded)) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer {} on {}: its designs would be judged on other plants than "
                            "the designs of other optimizers; a perturbation in `set` needs "
                            "perturbation.apply_to=training",
                            optimizer.label, problem.label));
  }
  if (leave_method_out(loaded) != leave_method_out(problem.loaded)) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer {} on {}: its settings change the requirements on a design",
                            optimizer.label, problem.label));
  }
  return loaded;
}

}  // namespace

void check_method_settings(const ConfigTable& optimizer, const AnySetting& set,
                           const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const std::string key = get_key(setting);
    if (key != kController &&
        std::ranges::find(kMethodTables, get_table(setting)) == std::end(kMethodTables)) {
      optimizer.refuse(
          set, fmt::format("{} is the same for every optimizer of a comparison. An optimizer may "
                           "only set how it spends its budget in training, and its controller: "
                           "schedule = \"KIND:K\", and in `set` racing.*, schedule.*, "
                           "perturbation.* and {}",
                           sanitize(key), kController));
    }
    if (key == "schedule.kind" || key == "schedule.cases" || key == "schedule.factor" ||
        key == "schedule.fixed_cases") {
      optimizer.refuse(set, fmt::format("for {} write schedule = \"KIND:K\"", key));
    }
  }
}

void load_methods(StudyPlan& plan) {
  for (StudyOptimizer& optimizer : plan.optimizers) {
    for (const StudyProblem& problem : plan.problems) {
      if (!optimizer.settings.empty()) {
        optimizer.loaded.insert_or_assign(problem.label,
                                          load_method(problem, optimizer, plan.programs));
      }
    }
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
                    fmt::format("value is \"failures\", which compares arms by their share of "
                                "failing test cases, but {} is {}",
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
                "reference is set, but the study has no [[target]]; the expected running times to "
                "targets are divided by those of the reference");
  }
}

}  // namespace armwright
