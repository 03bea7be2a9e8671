#include "study/run/run_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <compare>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/setting.hpp"
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

// Returns how many settings of a file are called `key`, in whatever table.
std::size_t count_settings(const SettingTable& table, std::string_view key) {
  auto count = static_cast<std::size_t>(
      std::ranges::count(table.settings, key, [](const AnySetting* one) { return one->key; }));
  for (const SettingTable* const inner : table.tables) {
    count += count_settings(*inner, key);
  }
  return count;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// Returns "substeps2" for a number and "engine_ode" for a word, or an empty text if a folder's name
// with such a part could mean other settings, too.
std::string make_folder_part(const RunPlan& plan, std::string_view key, std::string_view value) {
  const bool is_key =
      !key.empty() && is_letter(key.front()) &&
      std::ranges::all_of(key, [](char c) { return is_letter(c) || c == '_' || c == '.'; });
  const std::string_view digits = value.starts_with('-') ? value.substr(1) : value;
  const bool is_number = !digits.empty() && is_digit(digits.front()) && is_digit(digits.back()) &&
                         std::ranges::all_of(digits, [](char c) {
                           return is_digit(c) || c == '.' || c == 'e' || c == '-';
                         });
  const bool is_word =
      !value.empty() && is_letter(value.front()) && std::ranges::all_of(value, [](char c) {
        return is_letter(c) || is_digit(c) || c == '_' || c == '.';
      });
  if (!is_key || (!is_number && !is_word)) {
    return "";
  }
  const std::string part = fmt::format("{}{}{}", key, is_word ? "_" : "", value);
  for (std::size_t end = 1; end < part.size(); ++end) {  // whether another key reads as this part
    const std::string other = part.substr(0, end);
    const bool could_end = part[end] == '_' || is_digit(part[end]);
    if (could_end && other != key &&
        (count_settings(problem_settings(), other) > 0 || plan.options.values().contains(other))) {
      return "";
    }
  }
  return part;
}

// One thing that the user has set. `assignment` is what it means, and `part` what a folder's name shows of it;
// empty if that would not be clear.
struct NamedSetting {
  std::string assignment;
  std::string part;

  auto operator<=>(const NamedSetting&) const = default;
};

NamedSetting name_override(const RunPlan& plan, const std::string& setting) {
  const std::size_t middle = std::min(setting.find('='), setting.size());
  const auto strip = [](std::string_view text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t\""), text.size());
    return text.substr(begin, text.find_last_not_of(" \t\"") + 1 - begin);
  };
  const std::string_view all = setting;
  const std::string_view key = strip(all.substr(0, middle));
  const std::string_view value = strip(all.substr(std::min(middle + 1, all.size())));
  std::string_view shown = key.substr(key.rfind('.') + 1);
  const auto& options = plan.options.values();
  if (count_settings(problem_settings(), shown) != 1 || options.contains(std::string(shown))) {
    shown = key;
  }
  return {fmt::format("{}={}", key, value), make_folder_part(plan, shown, value)};
}

// Returns everything that the user has set and that changes the result, in an order of its own.
std::vector<NamedSetting> list_named_settings(const RunPlan& plan,
                                              std::span<const std::string> settings) {
  std::vector<NamedSetting> named;
  for (const std::string& setting : settings) {
    NamedSetting one = name_override(plan, setting);
    // The name of the problem has the name of the robot already.
    const bool is_robot = one.assignment.starts_with("robot.urdf=");
    const std::filesystem::path urdf = one.assignment.substr(one.assignment.find('=') + 1);
    if (!is_robot || plan.problem.name.find(urdf.stem().string()) == std::string::npos) {
      named.push_back(std::move(one));
    }
  }
  for (const OptionSpec& spec : plan.optimizer.options) {
    const auto value = plan.options.values().find(spec.name);
    if (spec.changes_result && value != plan.options.values().end() &&
        value->second != spec.fallback) {
      const std::string text = to_text(value->second);
      named.push_back(
          {fmt::format("option {}={}", spec.name, text), make_folder_part(plan, spec.name, text)});
    }
  }
  const auto add_words = [&](const char* what, const std::string& text) {
    std::string part = text;  // "fixed:10"
    part.erase(std::min(part.find(':'), part.size()), 1);
    std::ranges::replace(part, ':', '-');
    named.push_back({fmt::format("{}={}", what, text), std::move(part)});
  };
  if (const std::string schedule = to_text(plan.schedule);
      schedule != to_text(choose_schedule(plan.problem, plan.optimizer))) {
    add_words("schedule", schedule);
  }
  if (const std::string racing = to_text(plan.racing); racing != to_text(plan.problem.racing)) {
    add_words("racing", plan.racing.kind == Racing::Kind::none ? "racing_none" : racing);
  }
  std::ranges::sort(named);
  return named;
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

std::string explain_no_continuation(const RunPlan& plan) {
  const OptimizerRow& row = plan.optimizer;
  if (row.capabilities.paced && row.pace_option.empty()) {
    return fmt::format(
        "optimizer '{}' plans with the whole budget, so a larger budget changes its run from the "
        "beginning",
        sanitize(row.name));
  }
  if (plan.schedule.kind == Schedule::Kind::growing) {
    return fmt::format(
        "with schedule {} the number of cases grows only while the rest of the budget pays for "
        "more, so a larger budget changes the run",
        to_text(plan.schedule));
  }
  if (plan.racing.kind != Racing::Kind::none && can_race(row, plan.racing.kind)) {
    return fmt::format(
        "racing {} lets as many candidates compete as the rest of the budget pays for, so a larger "
        "budget changes the run",
        to_text(plan.racing));
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
      {"selection",
       {{"last", plan.selection.last},
        {"best", plan.selection.best},
        {"most", plan.selection.most}}},
  };
  if (plan.schedule.kind == Schedule::Kind::growing) {
    run["schedule"]["factor"] = plan.schedule.factor;
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

std::string make_folder_name(const RunPlan& plan, std::span<const std::string> settings) {
  constexpr std::size_t kLongest = 40, kHashDigits = 8;
  std::string suffix;
  std::string all;
  bool is_clear = true;
  for (const NamedSetting& one : list_named_settings(plan, settings)) {
    suffix += "-" + one.part;
    all += one.assignment + "\n";
    is_clear = is_clear && !one.part.empty();
  }
  if (!is_clear || suffix.size() > kLongest) {
    suffix = "-" + calc_sha256_hex(all).substr(0, kHashDigits);
  }
  return make_run_name(plan) + suffix;
}

}  // namespace armwright
