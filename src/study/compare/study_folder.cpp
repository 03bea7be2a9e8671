#include "study/compare/study_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/hash.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/optimizer_labels.hpp"
#include "study/compare/optimizer_streams.hpp"
#include "study/compare/study_plan.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kPlanFile = "study.toml";

// Writes what is not ASCII as JSON does (\u00e9), because the hash of a plan that 1.0 wrote depends
// on it. TOML forbids JSON's forms of delete and of characters beyond U+FFFF, whose UTF-8 begins with
// 0xf0; no plan of 1.0 with these could be read back.
std::string quote_setting(const std::string& text) {
  const auto is_unfit = [](unsigned char c) { return c >= 0xf0 || c == 0x7f; };
  return std::ranges::any_of(text, is_unfit)
             ? quote_toml(text)
             : json(text).dump(-1, ' ', true, json::error_handler_t::replace);
}

std::string quote_list(std::span<const std::string> texts) {
  std::vector<std::string> quoted;
  for (const std::string& text : texts) {
    quoted.push_back(quote_setting(text));
  }
  return "[" + join(quoted, ", ") + "]";
}

std::vector<std::string> list_options(const StudyOptimizer& optimizer) {
  std::vector<std::string> all;
  for (const auto& [name, value] : optimizer.parsed.values()) {
    if (is_recorded(optimizer.row.options, name, value)) {
      all.push_back(name + "=" + to_text(value));
    }
  }
  return all;
}

std::string format_toml_number(double value) {
  const std::string digits = format_exact(value);
  return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

// Returns the keys `value` and `reference` as TOML. Leaves out a key that has its default.
std::string make_questions(const StudyPlan& plan) {
  std::string text;
  if (plan.value == StudyValue::failures) {
    text += "value = \"failures\"\n";
  }
  if (!plan.reference.empty()) {
    text += fmt::format("reference = {}\n", quote_setting(plan.reference));
  }
  return text;
}

// Returns the targets as TOML, one table [[target]] per target.
std::string make_targets(const StudyPlan& plan) {
  std::string text;
  for (const StudyTarget& target : plan.targets) {
    text += fmt::format("\n[[target]]\nlabel = {}\nproblems = {}\n", quote_setting(target.label),
                        quote_list(target.problems));
    text += target.value ? fmt::format("value = {}\n", format_toml_number(*target.value)) : "";
    text += target.failures ? fmt::format("failures = {}\n", *target.failures) : "";
  }
  return text;
}

// Returns the keys of an optimizer that not every plan has.
std::string make_method(const StudyPlan& plan, const StudyOptimizer& optimizer) {
  std::string text = fmt::format("stream = {}\n", quote_setting(optimizer.stream));
  if (!optimizer.schedule && std::ranges::any_of(plan.problems, &StudyProblem::own_schedules)) {
    text += fmt::format("own_schedule = {}\n", quote_setting(to_text(optimizer.own_schedule)));
  }
  if (!optimizer.row.description.empty()) {
    text += fmt::format("description = {}\n", quote_setting(optimizer.row.description));
  }
  if (optimizer.schedule) {
    text += fmt::format("schedule = {}\n", quote_setting(to_text(*optimizer.schedule)));
  }
  if (!optimizer.settings.empty()) {
    text += fmt::format("set = {}\n", quote_list(optimizer.settings));
  }
  return text;
}

std::vector<std::string> list_inputs(const std::map<std::string, std::string>& hashes) {
  std::vector<std::string> inputs;
  for (const auto& [file, hash] : hashes) {
    inputs.push_back(file + " " + hash);
  }
  return inputs;
}

std::string make_body(const StudyPlan& plan) {
  std::string text = fmt::format(
      "name = {}\ntitle = {}\nseed = {}\nreplicates = {}\nbudget = {}\nstart_spread = {}\n"
      "constraint_tolerance = {}\ncheckpoints = {}\n{}final_engine = {}\nbaselines = "
      "{}\n{}\n[selection]\nlast = {}\nbest = {}\nmost = {}\n{}",
      quote_setting(plan.name), quote_setting(plan.title), plan.seed, plan.replicates, plan.budget,
      format_toml_number(plan.start_spread), format_toml_number(plan.constraint_tolerance),
      plan.checkpoints,
      plan.first_checkpoint > 1 ? fmt::format("first_checkpoint = {}\n", plan.first_checkpoint)
                                : "",
      quote_setting(plan.final_engine), plan.baselines ? "true" : "false", make_questions(plan),
      plan.selection.last, plan.selection.best, plan.selection.most,
      plan.judge_along ? "along = true\n" : "");
  for (const StudyProblem& problem : plan.problems) {
    const CaseSets& sets = problem.loaded.sets;
    const std::string inputs =
        problem.loaded.program.empty()
            ? ""
            : fmt::format("inputs = {}\n", quote_list(list_inputs(problem.loaded.input_hashes)));
    text += fmt::format(
        "\n[[problem]]\nname = {}\nlabel = {}\nset = {}\nschedule = {}\nvalidation_set = {}\n"
        "test_set = {}\nconfiguration_sha256 = {}\n{}",
        quote_setting(problem.name), quote_setting(problem.label), quote_list(problem.settings),
        quote_setting(describe_schedule(problem)), quote_setting(sets.validation),
        quote_setting(sets.test), quote_setting(calc_configuration_hash(problem.loaded)), inputs);
  }
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    text += fmt::format(
        "\n[[optimizer]]\nname = {}\nlabel = {}\nbaseline = {}\noptions = {}\ninputs = {}\n{}",
        quote_setting(optimizer.name), quote_setting(optimizer.label),
        optimizer.baseline ? "true" : "false", quote_list(list_options(optimizer)),
        quote_list(list_inputs(optimizer.row.input_hashes)), make_method(plan, optimizer));
  }
  return text + make_targets(plan);
}

// Throws Error{bad_data} if the folder's file is a plan that armwright has not recorded. A folder may
// come from anybody, and nobody agreed to run what such a plan names.
void check_plan_is_recorded(const std::filesystem::path& folder) {
  const auto file = folder / kPlanFile;
  if (!ConfigTable::load(file).has("plan_sha256")) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: cannot be read as a recorded plan: it has no plan_sha256, so it was "
                    "edited, or it is a plan of your own. Check the study with 'armwright "
                    "doctor {}', or choose another folder with --out or --new",
                    file.string(), folder.string()));
  }
}

StudyRequest make_folder_request(const std::filesystem::path& folder, PluginUse plugins) {
  check_study_folder(folder);
  FolderChecksums(folder).check(kPlanFile);
  check_plan_is_recorded(folder);
  StudyRequest request;
  request.file = (folder / kPlanFile).string();
  request.plugins = plugins;
  return request;
}

// Takes the description from every plugin of which the recorded plan has none.
void adopt_descriptions(const std::filesystem::path& recorded, StudyPlan& plan) {
  for (const NamedOptimizer& known : read_recorded_optimizers(recorded)) {
    const auto same = std::ranges::find(plan.optimizers, known.label, &StudyOptimizer::label);
    if (same != plan.optimizers.end() && known.description.empty()) {
      same->row.description.clear();
    }
  }
}

json index_by_label(const json& list, const char* ignored_key) {
  json by_label = json::object();
  for (json entry : list) {
    entry.erase(ignored_key);
    by_label[entry.at("label").get<std::string>()] = entry;
  }
  return by_label;
}

// Returns the differences between a problem's recorded configuration and the present one.
std::vector<std::string> describe_problem_change(const std::filesystem::path& folder,
                                                 const FolderChecksums& checksums,
                                                 const StudyProblem& problem) {
  const std::string name = make_problem_name(problem.label);
  const auto file = folder / name;
  if (!path_exists(file)) {
    return {};
  }
  const std::string recorded = checksums.read(name, kPlanLimit_bytes);
  check_json_depth(recorded, file.string());
  try {
    return describe_differences(recorded, problem.loaded.resolved_json);
  } catch (const json::exception& error) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: cannot be read as a recorded problem (damaged, or edited): {}. Check "
                    "the study with 'armwright doctor {}', or choose another folder with "
                    "--out or --new",
                    file.string(), describe_json_error(error.what()), folder.string()));
  }
}

// A study whose folder cannot be written can still be read.
RunLock take_lock(const Folder& folder) {
  try {
    return RunLock(folder);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::io || !is_study_folder(folder.path())) {
      throw;
    }
    throw Error(ErrorKind::io,
                fmt::format("{}; 'armwright show {}' reads the study and writes nothing",
                            error.what(), folder.path().string()));
  }
}

}  // namespace

std::string to_toml(const StudyPlan& plan) {
  const std::string body = make_body(plan);
  return fmt::format("plan_sha256 = \"{}\"\n{}", calc_sha256_hex(body), body);
}

std::string calc_plan_hash(const StudyPlan& plan) {
  return calc_sha256_hex(make_body(plan));
}

void adopt_recorded(const std::filesystem::path& folder, StudyPlan& plan) {
  if (!is_study_folder(folder)) {
    return;
  }
  FolderChecksums(folder).check(kPlanFile);
  adopt_labels(folder / kPlanFile, plan);
  if (plan.baselines) {
    keep_baselines(folder / kPlanFile, plan);
  }
  keep_simd_levels(folder / kPlanFile, plan);
  adopt_streams(folder / kPlanFile, plan);
  adopt_descriptions(folder / kPlanFile, plan);
}

bool is_study_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path / kPlanFile, ignored);
}

void check_study_folder(const std::filesystem::path& folder) {
  if (is_study_folder(folder)) {
    return;
  }
  std::error_code ignored;
  throw Error(ErrorKind::usage,
              std::filesystem::exists(folder, ignored)
                  ? fmt::format("{} is not the folder of a study: it has no {}",
                                sanitize(folder.string()), kPlanFile)
                  : fmt::format("there is no folder '{}'; name the folder of a study, "
                                "results/NAME or the one given to --out",
                                sanitize(folder.string())));
}

StudyPlan load_study_plan(const std::filesystem::path& folder) {
  return make_study_plan(make_folder_request(folder, PluginUse::read));
}

StudyPlan load_study_plan(const std::filesystem::path& folder, const AskUser& ask) {
  StudyRequest request = make_folder_request(folder, PluginUse::run);
  request.ask = ask;
  return make_study_plan(request);
}

namespace {

// Returns a sentence if the budgets of two plans differ, else an empty text.
std::string explain_study_budget(const json& recorded, const json& now) {
  return recorded.at("budget") == now.at("budget")
             ? ""
             : "Another budget needs another study, because every value, curve and rank in the "
               "finished cells is that of the recorded budget. ";
}

}  // namespace

StudyFolder::StudyFolder(const std::filesystem::path& path, const StudyPlan& plan)
    : folder_(Folder::make(path, path)), lock_(take_lock(folder_)) {
  const std::string text = to_toml(plan);
  if (!is_study_folder(path)) {
    for (const auto& entry : list_folder(path)) {
      const std::string name = entry.filename().string();
      if (name != "lock" && name != "problems" && name != kChecksumFile &&
          !name.ends_with(".new")) {
        throw Error(ErrorKind::usage,
                    fmt::format("{}: holds '{}' but no {}, so it is not the folder of a study; "
                                "choose another with --out, or --new",
                                path.string(), sanitize(name), kPlanFile));
      }
    }
  }
  FolderChecksums checksums(folder_);
  if (is_study_folder(path)) {
    extend(plan, text, checksums);
  }
  std::vector<std::pair<std::string, std::string>> files;
  for (const StudyProblem& problem : plan.problems) {
    files.emplace_back(make_problem_name(problem.label),
                       json::parse(problem.loaded.resolved_json).dump(2) + "\n");
  }
  if (!is_study_folder(path) || !additions_.empty()) {
    files.emplace_back(kPlanFile, text);
  }
  checksums.write(files);
  checksums.cover(kPlanFile);
  checksums.save();
  uncover_unfinished(plan, list_cells(plan), path);
}

void StudyFolder::extend(const StudyPlan& plan, const std::string& text,
                         FolderChecksums& checksums) {
  const auto file = path() / kPlanFile;
  checksums.check(kPlanFile);
  check_plan_is_recorded(path());
  check_plan_hash(file);
  json recorded = json::parse(ConfigTable::load(file).to_json());
  json now = json::parse(ConfigTable::parse(text, file.string()).to_json());
  std::vector<std::string> differences;
  for (const char* key : {"problem", "optimizer"}) {
    // The file of a problem and the origin of a baseline may differ.
    const char* ignored = key == std::string_view("problem") ? "name" : "baseline";
    const json before = index_by_label(recorded.at(key), ignored);
    const json after = index_by_label(now.at(key), ignored);
    for (const auto& [label, entry] : before.items()) {
      if (!after.contains(label)) {
        differences.push_back(fmt::format(
            "{} {} is in the recorded plan, but not in this one; add it", key, sanitize(label)));
        continue;
      }
      json now_entry = after[label];
      if (!entry.contains("own_schedule")) {  // no recorded problem has own schedules
        now_entry.erase("own_schedule");
      }
      for (const std::string& difference : describe_differences(entry.dump(), now_entry.dump())) {
        differences.push_back(fmt::format("{} {}: {}", key, sanitize(label), difference));
      }
    }
    for (const auto& [label, entry] : after.items()) {
      if (!before.contains(label)) {
        additions_.push_back(fmt::format("{} {}", key, sanitize(label)));
      }
    }
    recorded.erase(key);
    now.erase(key);
  }
  for (const StudyProblem& problem : plan.problems) {
    for (const std::string& difference : describe_problem_change(path(), checksums, problem)) {
      differences.push_back(fmt::format("problem {}: {}", problem.label, difference));
    }
  }
  const auto replicates = recorded.at("replicates").get<int>();
  if (replicates < plan.replicates) {
    additions_.push_back(fmt::format("replicates {} to {}", replicates + 1, plan.replicates));
  }
  if (replicates <= plan.replicates) {
    now["replicates"] = replicates;
  }
  // These keys may change: values that the cells lack are computed from their journals.
  constexpr const char* kQuestions[] = {"value", "reference", "target"};
  if (std::ranges::any_of(kQuestions, [&](const char* key) {
        return recorded.value(key, json()) != now.value(key, json());
      })) {
    additions_.push_back("changed: targets, reference or value");
  }
  for (const char* key :
       {"plan_sha256", "name", "title", "baselines", "value", "reference", "target"}) {
    recorded.erase(key);
    now.erase(key);
  }
  for (const std::string& difference : describe_differences(recorded.dump(), now.dump())) {
    differences.push_back(difference);
  }
  if (!differences.empty()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{} holds a study whose cells could not be compared with those of "
                    "this plan:\n  {}\n{}Replicates, problems and optimizers can only be added. To "
                    "continue the recorded study: armwright compare {} --out {}. For another one: "
                    "--new, or another folder with --out",
                    path().string(), join(differences, "\n  "), explain_study_budget(recorded, now),
                    file.string(), path().string()));
  }
  if (!additions_.empty()) {
    int number = 1;
    while (path_exists(path() / fmt::format("study-{:03}.toml", number))) {
      ++number;
    }
    const std::pair<std::string, std::string> before(fmt::format("study-{:03}.toml", number),
                                                     checksums.read(kPlanFile, kPlanLimit_bytes));
    checksums.write({&before, 1});
    checksums.save();
  }
}

void cover_study(const StudyPlan& plan, const std::filesystem::path& study) {
  FolderChecksums checksums(study);
  for (const Cell& cell : list_cells(plan)) {
    const auto folder = make_cell_path(plan, cell);
    if (path_exists(study / folder / "cell.json")) {
      checksums.cover((folder / kChecksumFile).string());
    }
  }
  for (const std::string& name : list_study_files(study)) {
    checksums.cover(name);
  }
  checksums.save();
}

std::vector<std::string> list_study_files(const std::filesystem::path& study) {
  std::vector<std::string> names;
  const auto add = [&](const std::filesystem::path& file, bool is_wanted) {
    if (is_wanted && !std::filesystem::is_symlink(file) && regular_file_exists(file)) {
      names.push_back(file.lexically_relative(study).string());
    }
  };
  for (const auto& file : list_folder(study)) {
    const std::string name = file.filename().string();
    add(file, name == kPlanFile || name == "result.json" || name == "verdict.txt" ||
                  (name.starts_with("study-") && name.ends_with(".toml")));
  }
  for (const char* part : {"problems", "final", "tables"}) {
    if (folder_exists(study / part)) {
      for (const auto& file : list_tree(study / part)) {
        add(file, file.extension() == ".json" || file.extension() == ".csv");
      }
    }
  }
  std::ranges::sort(names);
  return names;
}

void uncover_unfinished(const StudyPlan& plan, std::span<const Cell> cells,
                        const std::filesystem::path& study) {
  FolderChecksums checksums(study);
  std::vector<std::string> unfinished;
  for (const Cell& cell : cells) {
    const std::string name = (make_cell_path(plan, cell) / kChecksumFile).string();
    if (checksums.covers(name) && !load_cell(plan, cell, study)) {
      unfinished.push_back(name);
    }
  }
  checksums.drop(unfinished);
}

}  // namespace armwright
