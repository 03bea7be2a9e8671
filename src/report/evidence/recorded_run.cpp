#include "report/evidence/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_loader.hpp"
#include "report/evidence/page_json.hpp"
#include "sim/simd/simd_level.hpp"
#include "study/compare/incumbents.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// An argument of the command line that names a problem, the problem's file, and the settings that
// name its robot.
struct NamedProblem {
  std::string argument;
  fs::path file;
  std::vector<std::string> settings = {};
};

// Returns the problem of `optimize --robot FILE`. The recorded path of the robot is absolute.
std::optional<NamedProblem> find_problem_of_robot(const RecordedRun& run) {
  const bool has_robot = std::ranges::any_of(run.command_line, [](const std::string& word) {
    return word == "--robot" || word.starts_with("--robot=");
  });
  const json robot = run.configuration.at("problem").value("robot", json::object());
  if (!has_robot || !robot.value("propose", false)) {
    return std::nullopt;
  }
  NamedProblem named{"robot", resolve_config("problems", "robot")};
  for (const char* key : {"urdf", "base", "tip"}) {
    if (robot.contains(key)) {
      named.settings.push_back(
          fmt::format("robot.{}={}", key, quote_toml(robot[key].get<std::string>())));
    }
  }
  return named;
}

// Returns PROBLEM of `optimize PROBLEM`, or the problem of `optimize --robot FILE`. For a cell of a study it is the shipped problem with the
// name of the run's problem. Returns nothing if no such file exists any more.
std::optional<NamedProblem> find_named_problem(const RecordedRun& run) {
  std::vector<std::string> words = run.command_line;
  const auto command = std::ranges::find(words, "optimize");
  words.erase(words.begin(), command == words.end() ? command : command + 1);
  words.push_back(run.problem_name);
  for (const std::string& word : words) {
    const bool is_path = word.find('/') != std::string::npos;
    if (word.starts_with("-") || word.empty() || (is_path && !word.ends_with(".toml"))) {
      continue;
    }
    try {
      const fs::path file = resolve_config("problems", word);
      if (run.problem_name.empty() || file.stem() == run.problem_name) {
        return NamedProblem{word, file};
      }
    } catch (const Error&) {
      // The argument is something else, such as the value of an option.
    }
  }
  return find_problem_of_robot(run);
}

// Returns the settings that decide how a design is judged. The title and the settings of training
// (racing, schedules, abandonment) are not among them.
std::map<std::string, json> list_settings(const json& resolved) {
  std::map<std::string, json> settings;
  for (const char* table : {"robot", "task", "control", "physics", "motors", "perturbation",
                            "workspace", "objective", "variables", "function", "motion", "tubes"}) {
    if (resolved.contains(table) && resolved[table].is_object()) {
      for (const auto& [key, value] : resolved[table].items()) {
        settings[fmt::format("{}.{}", table, key)] = value;
      }
    }
  }
  for (const char* tables : {"obstacle", "requirement"}) {
    if (resolved.contains(tables)) {
      settings[tables] = resolved[tables];
    }
  }
  if (resolved.contains("function")) {
    settings.try_emplace("function.instance", 0);  // the plain form is recorded without a number
  }
  if (resolved.contains("robot")) {  // likewise these, which version 1.0 did not have
    settings.try_emplace("robot.dynamics", false);
    settings.try_emplace("robot.plant", "");
    settings.try_emplace("robot.repair", false);
    settings.try_emplace("control.start", "empty");
  }
  if (const auto start = settings.find("variables.start");
      start != settings.end() && start->second == kProposedStart) {
    settings.try_emplace("variables.start_bandwidth_rad_per_s", 0);
  }
  return settings;
}

// Returns the value as TOML, but a single word without quotes.
std::string write_value(const json& value) {
  if (value.is_array() || value.is_object()) {
    std::vector<std::string> parts;
    for (const auto& [key, part] : value.items()) {
      const std::string text = part.is_string() ? part.dump() : write_value(part);
      parts.push_back(value.is_object() ? key + "=" + text : text);
    }
    const std::string inside = join(parts, ",");
    return value.is_object() ? "{" + inside + "}" : "[" + inside + "]";
  }
  if (!value.is_string()) {
    return value.dump();
  }
  const auto text = value.get<std::string>();
  const bool is_word = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;
  const bool has_meaning =
      text.empty() || text == "true" || text == "false" || text == "inf" || text == "nan";
  return is_word && !has_meaning ? text : value.dump();
}

std::vector<std::string> list_overrides(const json& from, const json& to) {
  const auto before = list_settings(from);
  std::vector<std::string> overrides;
  for (const auto& [key, value] : list_settings(to)) {
    const auto found = before.find(key);
    if (found == before.end() || found->second != value) {
      overrides.push_back(key + "=" + write_value(value));
    }
  }
  return overrides;
}

// Returns the arguments that lead to exactly this problem, or none.
std::vector<std::string> find_problem_arguments(const NamedProblem& named, const json& recorded) {
  try {
    const json plain = json::parse(load_problem(named.file.string(), named.settings).resolved_json);
    std::vector<std::string> all = named.settings;
    std::ranges::copy(list_overrides(plain, recorded), std::back_inserter(all));
    // First without the SIMD level: then the arguments suit other machines too.
    std::vector<std::string> fewer = all;
    std::erase_if(fewer, [](const auto& text) { return text.starts_with("physics.simd="); });
    for (const auto& overrides : {fewer, all}) {
      const json changed = json::parse(load_problem(named.file.string(), overrides).resolved_json);
      if (list_settings(changed) == list_settings(recorded)) {
        std::vector<std::string> arguments = {"--problem", named.argument};
        for (const std::string& text : overrides) {
          arguments.insert(arguments.end(), {"--set", text});
        }
        return arguments;
      }
    }
  } catch (const Error&) {
    // The problem's file has changed and cannot be used any more.
  }
  return {};
}

void read_manifest(RecordedRun& run) {
  const auto file = run.folder / "manifest.json";
  if (!path_exists(file)) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is not the folder of a run (it has no manifest.json)",
                            sanitize(run.folder.string())));
  }
  try {
    const json manifest = json::parse(read_checked_json(file, kManifestLimit_bytes));
    run.configuration = manifest.at("configuration");
    run.build = manifest.at("build").get<std::map<std::string, std::string>>();
    run.command_line = manifest.at("command_line").get<std::vector<std::string>>();
    run.started = manifest.value("started", "");
    const json& settings = run.configuration.at("run");
    run.budget = settings.at("budget").get<std::int64_t>();
    run.schedule = read_recorded_schedule(settings.at("schedule"));
    settings.at("optimizer").get<std::string>();
    settings.at("options").get<std::map<std::string, json>>();
    settings.at("seed").get<std::uint64_t>();
    run.configuration.at("problem").at("kind").get<std::string>();
    run.configuration.at("inputs").get<std::map<std::string, std::string>>();
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a manifest that armwright wrote ({})",
                            sanitize(file.string()), describe_json_error(error.what())));
  }
}

void read_name(RecordedRun& run) {
  if (run.result) {
    run.problem_name = run.result->problem;
    return;
  }
  const auto cell = run.folder / "cell.json";
  if (path_exists(cell)) {
    const json content = json::parse(read_checked_json(cell, kCellLimit_bytes), nullptr, false);
    if (content.is_object() && content.contains("problem") && content["problem"].is_string()) {
      run.problem_name = content["problem"].get<std::string>();
      return;
    }
  }
  if (const auto named = find_named_problem(run)) {
    run.problem_name = named->file.stem().string();
  }
}

// Returns the names of the problem's files that differ from those that the run used.
std::vector<std::string> list_changed_inputs(const RecordedRun& run, const LoadedProblem& problem) {
  std::vector<std::string> changed;
  const json& recorded = run.configuration.at("inputs");
  for (const auto& [name, hash] : problem.input_hashes) {
    if (!recorded.contains(name) || recorded[name] != hash) {
      changed.push_back(sanitize(name));
    }
  }
  return changed;
}

// Replaces a SIMD level that this machine does not have. Only the last bits of results may differ.
json choose_simd(json problem, std::vector<std::string>& notes) {
  const json::json_pointer level("/physics/simd");
  if (!problem.contains(level) || !problem[level].is_string()) {
    return problem;
  }
  const auto possible = supported_simd_names();
  const auto name = problem[level].get<std::string>();
  if (name != "auto" && std::ranges::find(possible, name) == possible.end()) {
    notes.push_back(
        fmt::format("The run was made with the SIMD level {}, which this machine "
                    "lacks: what is simulated for this page may differ in the last "
                    "digits.",
                    sanitize(name)));
    problem[level] = "auto";
  }
  return problem;
}

void rebuild_problem(RecordedRun& run) {
  const auto named = find_named_problem(run);
  run.input_folder = named ? named->file.parent_path() : run.folder;
  if (run.is_identification()) {
    run.problem_fault = "An identification has no design.";
    return;
  }
  const json& recorded = run.configuration.at("problem");
  const json usable = choose_simd(recorded, run.notes);
  constexpr const char* kConsequence =
      "Parts that need a simulation are left out, so that the page does not show the numbers of "
      "another problem.";
  try {
    LoadedProblem problem =
        load_recorded_problem(usable.dump(), run.problem_name, run.input_folder);
    const auto changed = list_changed_inputs(run, problem);
    if (!changed.empty()) {
      run.problem_fault = fmt::format("These files of the problem have changed since the run: {}.",
                                      join(changed, ", "));
      run.notes.push_back(run.problem_fault + " " + kConsequence);
      return;
    }
    if (named) {
      run.problem_arguments = find_problem_arguments(*named, json::parse(problem.resolved_json));
    }
    run.problem = std::move(problem);
  } catch (const Error& error) {
    run.problem_fault = fmt::format("The problem cannot be rebuilt as the run recorded it ({}).",
                                    sanitize(error.what()));
    run.notes.push_back(run.problem_fault + " " + kConsequence);
  }
}

void compare_builds(RecordedRun& run) {
  const auto now = describe_build();
  std::vector<std::string> differences;
  for (const char* key : {"version", "git", "compiler", "ode", "cpu"}) {
    const auto recorded = run.build.find(key);
    if (recorded != run.build.end() && recorded->second != now.at(key)) {
      differences.push_back(
          fmt::format("{} {} then, {} now", key, sanitize(recorded->second), now.at(key)));
    }
  }
  if (!differences.empty()) {
    run.notes.push_back(
        fmt::format("The run was made by another program or machine than this "
                    "page: {}.",
                    join(differences, "; ")));
  }
}

}  // namespace

ProblemDescription RecordedRun::describe() const {
  if (problem) {
    return problem->problem->description();
  }
  ProblemDescription description;
  description.name = problem_name;
  description.objectives = {{"objective", ""}};
  if (result) {
    description.objectives = result->objectives;
    description.objective_weights = result->objective_weights;
    description.constraints = result->constraints;
    description.limits = result->limits;
  }
  return description;
}

bool RecordedRun::is_identification() const {
  return configuration.at("problem").at("kind") == "identification";
}

json RecordedRun::make_quantity(const Quantity& quantity) const {
  return armwright::make_quantity(quantity, !has_arm());
}

std::vector<double> RecordedRun::find_best() const {
  if (result) {
    return result->winner ? result->judged[*result->winner].candidate.x : std::vector<double>{};
  }
  const auto incumbents = find_incumbents(describe(), journal.training, schedule);
  return incumbents.empty() ? std::vector<double>{}
                            : journal.training.find(incumbents.back().evaluation).value().x;
}

fs::path RecordedRun::find_urdf() const {
  const auto urdf = configuration.at("problem").at("robot").at("urdf").get<std::string>();
  return resolve_config("robots", urdf, input_folder);
}

RobotModel RecordedRun::load_robot() const {
  const json& robot = configuration.at("problem").at("robot");
  RobotOptions options;
  options.base = robot.value("base", "");
  options.tip = robot.value("tip", "");
  options.density_kg_per_m3 = robot.value("density_kg_per_m3", 0.0);
  options.repair = robot.value("repair", false);
  options.mass_from_shapes = robot.value("mass_from_shapes", true);
  for (const auto& text : robot.value("packages", std::vector<std::string>())) {
    const std::size_t at = text.find('=');
    if (at != std::string::npos) {
      options.packages[text.substr(0, at)] = input_folder / text.substr(at + 1);
    }
  }
  return load_urdf(find_urdf(), options);
}

std::string RecordedRun::make_begin_command() const {
  std::vector<std::string> words = command_line;
  if (!words.empty()) {
    words.front() = fs::path(words.front()).filename().string();
  }
  return quote_command(words);
}

std::string RecordedRun::make_evaluate_command(const std::string& design,
                                               const std::vector<std::string>& arguments) const {
  if (problem_arguments.empty()) {
    return "";
  }
  std::vector<std::string> all = {"armwright", "evaluate", design};
  all.insert(all.end(), problem_arguments.begin(), problem_arguments.end());
  all.insert(all.end(), arguments.begin(), arguments.end());
  return quote_command(all);
}

RecordedRun read_recorded_run(const fs::path& folder) {
  RecordedRun run;
  run.folder = folder;
  read_manifest(run);
  // Reads the result before the journal: then the journal holds at least every evaluation that the
  // result counts.
  if (path_exists(folder / "result.json")) {
    run.result = load_result(folder);
  }
  if (path_exists(folder / "journal")) {
    run.journal = read_journal(folder / "journal");
  }
  read_name(run);
  compare_builds(run);
  rebuild_problem(run);
  if (run.problem) {
    const std::size_t variables = run.problem->problem->description().variables.size();
    for (const EvaluationRecord& record : run.journal.training) {
      if (record.x.size() != variables) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}: evaluation {} has {} variables, but the problem {}; they "
                                "belong to different runs",
                                sanitize((folder / "journal").string()), record.index + 1,
                                record.x.size(), variables));
      }
    }
  }
  return run;
}

}  // namespace armwright
