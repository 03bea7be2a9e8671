#include "study/run_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json to_json_value(const OptionValue& value) {
  return std::visit([](const auto& v) { return json(v); }, value);
}

}  // namespace

Schedule choose_schedule(const LoadedProblem& problem, const OptimizerRow& optimizer) {
  if (problem.schedule.fresh && !optimizer.capabilities.generations) {
    return {.fresh = false, .cases = problem.fixed_cases};
  }
  return problem.schedule;
}

std::optional<Schedule> read_schedule(std::string_view text) {
  constexpr std::int64_t kMostCases = 1'000'000;
  const auto parts = split(text, ':');
  const auto cases = parts.size() == 2 ? parse_integer(parts[1]) : std::nullopt;
  if (!cases || *cases < 1 || *cases > kMostCases || (parts[0] != "fresh" && parts[0] != "fixed")) {
    return std::nullopt;
  }
  return Schedule{parts[0] == "fresh", static_cast<int>(*cases)};
}

std::string to_text(const Schedule& schedule) {
  return fmt::format("{}:{}", schedule.fresh ? "fresh" : "fixed", schedule.cases);
}

void check_plan(const RunPlan& plan) {
  const OptimizerRow& row = plan.optimizer;
  const std::string unsuitable = explain_unsuitable(row, plan.problem.problem->description());
  if (!unsuitable.empty()) {
    throw Error(ErrorKind::usage, fmt::format("optimizer '{}' cannot work on {}: {}", row.name,
                                              plan.problem.name, unsuitable));
  }
  if (plan.schedule.fresh && !row.capabilities.generations) {
    throw Error(
        ErrorKind::usage,
        fmt::format("optimizer '{}' has no generations, so new training cases for every "
                    "generation (schedule fresh) mean nothing to it; use --schedule fixed:K, "
                    "which evaluates every candidate on the same K cases",
                    row.name));
  }
  if (plan.budget < 0) {
    throw Error(ErrorKind::usage, fmt::format("--budget is {}; it must be >= 0", plan.budget));
  }
}

std::string to_json(const RunPlan& plan) {
  json options = json::object();
  for (const auto& [name, value] : plan.options.values()) {
    const auto spec = std::ranges::find(plan.optimizer.options, name, &OptionSpec::name);
    if (spec == plan.optimizer.options.end() || spec->changes_result) {
      options[name] = to_json_value(value);
    }
  }
  const json run = {
      {"optimizer", plan.optimizer.name},
      {"options", options},
      {"seed", plan.seed},
      {"budget", plan.budget},
      {"schedule",
       {{"kind", plan.schedule.fresh ? "fresh" : "fixed"}, {"cases", plan.schedule.cases}}},
      {"selection", {{"last", plan.selection.last}, {"best", plan.selection.best}}},
  };
  std::map<std::string, std::string> inputs = plan.problem.input_hashes;
  inputs.insert(plan.optimizer.input_hashes.begin(), plan.optimizer.input_hashes.end());
  const json whole = {
      {"problem", json::parse(plan.problem.resolved_json)}, {"inputs", inputs}, {"run", run}};
  return whole.dump(2);
}

namespace {

// A setting by the name that it has had since.
std::string rename_old_key(const std::string& pointer) {
  constexpr std::string_view kOld = "/task/control_period_s";
  return pointer.ends_with(kOld)
             ? pointer.substr(0, pointer.size() - kOld.size()) + "/control/period_s"
             : pointer;
}

}  // namespace

std::vector<std::string> describe_differences(const std::string& recorded_json,
                                              const std::string& now_json) {
  json recorded;
  for (const auto& [key, value] : json::parse(recorded_json).flatten().items()) {
    recorded[rename_old_key(key)] = value;
  }
  const json now = json::parse(now_json).flatten();
  std::vector<std::string> differences;
  const auto name = [](std::string pointer) {
    pointer.erase(0, 1);
    for (char& c : pointer) {
      c = c == '/' ? '.' : c;
    }
    return sanitize(pointer);
  };
  for (const auto& [key, value] : recorded.items()) {
    if (!now.contains(key)) {
      differences.push_back(fmt::format("{}: recorded {}, now absent", name(key), value.dump()));
    } else if (now[key] != value) {
      differences.push_back(
          fmt::format("{}: recorded {}, now {}", name(key), value.dump(), now[key].dump()));
    }
  }
  for (const auto& [key, value] : now.items()) {
    if (!recorded.contains(key)) {
      differences.push_back(fmt::format("{}: recorded absent, now {}", name(key), value.dump()));
    }
  }
  return differences;
}

std::string make_run_name(const RunPlan& plan) {
  std::string optimizer = plan.optimizer.name;
  for (char& c : optimizer) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_';
    c = plain ? c : '-';
  }
  // "./libmine.so" and "exec:python3 -u mine.py": neither hidden nor a path.
  optimizer.erase(0, optimizer.find_first_not_of("-."));
  return fmt::format("{}-{}-seed{}", plan.problem.name, optimizer, plan.seed);
}

}  // namespace armwright
