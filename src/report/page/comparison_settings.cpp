#include "report/page/comparison_settings.hpp"

#include <algorithm>
#include <utility>

#include "base/config.hpp"
#include "base/text.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Adds every number and text in `value` under its dotted key.
void flatten(const json& value, const std::string& key, std::map<std::string, std::string>& all) {
  if (value.is_object()) {
    for (const auto& [name, one] : value.items()) {
      flatten(one, key.empty() ? name : key + "." + name, all);
    }
  } else {
    all[key] = value.is_string() ? value.get<std::string>() : value.dump();
  }
}

constexpr const char* kBudget = "the budget";

// Returns the part of the basis that a key of a problem belongs to, in words. Only keys that are
// known not to change what is measured, nor the start, belong to none.
std::string find_basis(const std::string& key) {
  const auto is_in = [&](const char* table) {
    return key == table || key.starts_with(table + std::string("."));
  };
  if (is_in("run") || is_in("schedule") || is_in("racing") || is_in("sweep") ||
      is_in("sets.training") || is_in("sets.validation") || is_in("sets.validation_cases")) {
    return "";
  }
  constexpr std::pair<const char*, const char*> kParts[] = {{"sets", kBasisTestSet},
                                                            {"physics", "the engine"},
                                                            {"control", "the controller"},
                                                            {"training", "the training"},
                                                            {"variables", "the search space"}};
  const auto part = std::ranges::find_if(kParts, [&](const auto& one) { return is_in(one.first); });
  return part == std::end(kParts) ? kBasisProblem : part->second;
}

// Adds every setting of a problem, without its title and description.
void add_problem(const json& configuration, const std::string& prefix, ComparedSettings& settings) {
  std::map<std::string, std::string> all;
  flatten(configuration, "", all);
  for (const auto& [key, text] : all) {
    if (key != "title" && key != "description" && key != "physics.simd" &&
        !key.starts_with("published")) {
      settings[prefix + key] = {text, find_basis(key)};
    }
  }
}

// Adds every number and text in `value`, which do not belong to the basis.
void add_rest(const json& value, const std::string& key, ComparedSettings& settings) {
  std::map<std::string, std::string> all;
  flatten(value, key, all);
  for (const auto& [name, text] : all) {
    settings[name] = {text, ""};
  }
}

template <typename Items>
std::set<std::string> list_labels(const Items& items) {
  std::set<std::string> labels;
  for (const auto& one : items) {
    labels.insert(one.label);
  }
  return labels;
}

std::string join_labels(const std::set<std::string>& labels) {
  return join(std::vector<std::string>(labels.begin(), labels.end()), ", ");
}

// Returns the settings of a problem of a study, with names that begin with `prefix`. Budget and
// default optimizer of the problem itself count for no study.
ComparedSettings list_problem_settings(const StudyProblem& problem, const std::string& prefix) {
  json configuration = json::parse(problem.loaded.resolved_json);
  configuration.erase("run");
  configuration["schedule"] = describe_schedule(problem);
  ComparedSettings settings;
  add_problem(configuration, prefix, settings);
  for (const auto& [file, hash] : problem.loaded.input_hashes) {
    settings[prefix + "inputs." + file] = {hash, kBasisProblem};
  }
  return settings;
}

}  // namespace

std::set<std::string> list_obstacles(const ComparedSettings& a, const ComparedSettings& b) {
  std::set<std::string> parts;
  for (const auto& [mine, theirs] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    for (const auto& [key, one] : *mine) {
      const auto other = theirs->find(key);
      if (!one.basis.empty() && (other == theirs->end() || other->second.text != one.text)) {
        parts.insert(one.basis);
      }
    }
  }
  return parts;
}

json make_compared_settings(const ComparedSettings& a, const ComparedSettings& b) {
  ComparedSettings all = a;
  all.insert(b.begin(), b.end());
  const auto find = [](const ComparedSettings& settings, const std::string& key) {
    const auto found = settings.find(key);
    return found == settings.end() ? json(nullptr) : json(sanitize(found->second.text));
  };
  json list = json::array();
  for (const auto& [key, one] : all) {
    list.push_back({{"name", sanitize(key)},
                    {"a", find(a, key)},
                    {"b", find(b, key)},
                    {"basis", one.basis.empty() ? json(nullptr) : json(one.basis)}});
  }
  return list;
}

ComparedSettings list_settings(const RecordedRun& run) {
  ComparedSettings settings;
  add_rest(run.configuration.at("run"), "run", settings);
  add_problem(run.configuration.at("problem"), "problem.", settings);
  settings["run.problem"] = {run.problem_name, kBasisProblem};
  if (const auto budget = settings.find("run.budget"); budget != settings.end()) {
    budget->second.basis = kBudget;
  }
  for (const auto& [file, hash] : run.configuration.at("inputs").items()) {
    // The other files are those of a plugin.
    const bool is_problems = !run.problem || run.problem->input_hashes.contains(file);
    settings["inputs." + file] = {hash.get<std::string>(), is_problems ? kBasisProblem : ""};
  }
  return settings;
}

ComparedSettings list_settings(const StudyProblem& problem) {
  return list_problem_settings(problem, "");
}

ComparedSettings list_settings(const StudyPlan& plan, const StudyPlan& other) {
  json recorded = json::parse(ConfigTable::parse(to_toml(plan), "study.toml").to_json());
  const json optimizers = recorded.at("optimizer");
  for (const char* key : {"plan_sha256", "name", "title", "problem", "optimizer"}) {
    recorded.erase(key);
  }
  ComparedSettings settings;
  add_rest(recorded, "", settings);
  settings["budget"].basis = kBudget;
  settings["constraint_tolerance"].basis = "the tolerance of constraints";
  settings["value"] = {plan.value == StudyValue::failures ? "failures" : "objective",
                       "the value of a run"};
  settings["problems"] = {join_labels(list_labels(plan.problems)), ""};
  settings["optimizers"] = {join_labels(list_labels(plan.optimizers)), ""};
  for (const StudyProblem& problem : plan.problems) {
    if (list_labels(other.problems).contains(problem.label)) {
      settings.merge(list_problem_settings(problem, "problems." + problem.label + "."));
    }
  }
  for (json one : optimizers) {
    const auto label = one.at("label").get<std::string>();
    if (list_labels(other.optimizers).contains(label)) {
      for (const char* key : {"label", "baseline", "description"}) {
        one.erase(key);
      }
      add_rest(one, "optimizers." + label, settings);
    }
  }
  return settings;
}

}  // namespace armwright
