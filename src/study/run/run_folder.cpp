#include "study/run/run_folder.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/interface/schedule.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Creates the folder, or accepts one that is empty or holds a run. Refuses others, because the
// run's files must not replace the user's own files of the same names.
Folder claim_folder(const std::filesystem::path& path, const std::filesystem::path& root) {
  Folder folder = Folder::make(path, root);
  if (path_exists(path / "manifest.json")) {
    return folder;
  }
  for (const auto& entry : list_folder(path)) {
    const std::string name = entry.filename().string();
    // A kill at the very start leaves these.
    if (name != "lock" && name != "manifest.json.new" && !name.starts_with(kChecksumFile)) {
      throw Error(
          ErrorKind::usage,
          fmt::format("{}: holds '{}' but no manifest.json, so it is not the folder of a run; "
                      "choose another folder with --out or --new",
                      path.string(), sanitize(name)));
    }
  }
  return folder;
}

// Returns whether the rights of the lock, or of the folder without one, forbid to write.
bool is_read_only(const Folder& folder) {
  if (::faccessat(folder.get(), "lock", W_OK, AT_EACCESS) == 0) {
    return false;
  }
  if (errno == ENOENT) {
    return ::faccessat(folder.get(), ".", W_OK, AT_EACCESS) != 0;
  }
  return errno == EACCES || errno == EPERM || errno == EROFS;
}

// Takes the lock for writing. Where the rights do not allow that, a recorded run can still be
// shown: then it takes the lock for reading and stores the reason in `obstacle`.
RunLock take_lock(const Folder& folder, std::string& obstacle) {
  try {
    return RunLock(folder);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::io || !is_read_only(folder) ||
        !path_exists(folder.path() / "manifest.json")) {
      throw;
    }
    obstacle = error.what();
    return RunLock::for_reading(folder.path());
  }
}

json make_manifest(const RunPlan& plan, std::span<const std::string> command_line) {
  json words = json::array();
  for (const std::string& word : command_line) {
    words.push_back(sanitize(word));
  }
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return {{"format", kManifestFormat},
          {"configuration", json::parse(to_json(plan))},
          {"has_checksums", true},  // SHA256SUMS exists since before the manifest
          {"build", describe_build()},
          {"command_line", words},
          {"started", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))}};
}

json read_manifest(const std::filesystem::path& file) {
  try {
    json manifest = json::parse(read_checked_json(file, kManifestLimit_bytes));
    if (manifest.at("format") != kManifestFormat) {
      throw std::runtime_error(
          fmt::format("its format is {}, and this version of armwright reads format {}; resume the "
                      "run with the version that began it, or choose another folder with --out or "
                      "--new",
                      manifest.at("format").dump(), kManifestFormat));
    }
    if (is_of_version_1(manifest)) {
      throw std::runtime_error(kIsOfVersion1);
    }
    manifest.at("build").get<std::map<std::string, std::string>>();
    manifest["has_checksums"] = manifest.value("has_checksums", false);
    return manifest;
  } catch (const json::exception& error) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: is not a manifest that armwright wrote ({}); choose another folder "
                    "with --out or --new",
                    file.string(), describe_json_error(error.what())));
  } catch (const std::runtime_error& error) {
    if (dynamic_cast<const Error*>(&error) != nullptr) {
      throw;
    }
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", file.string(), sanitize(error.what())));
  }
}

// Returns advice if the recorded SIMD level differs from the present one, else an empty text.
std::string explain_simd(const json& recorded, const json& now) {
  const json::json_pointer level("/problem/physics/simd");
  if (!recorded.contains(level) || !recorded[level].is_string() || !now.contains(level) ||
      recorded[level] == now[level]) {
    return "";
  }
  const auto name = recorded[level].get<std::string>();
  const auto possible = supported_simd_names();
  if (std::ranges::find(possible, name) == possible.end()) {
    return fmt::format(
        "\nThe SIMD level decides the last bits of every result, and this CPU lacks {}; resume the "
        "run on a machine that has it",
        sanitize(name));
  }
  return fmt::format(
      "\nThe SIMD level decides the last bits of every result; to resume this run, pass --simd {}",
      sanitize(name));
}

// Returns the value at a JSON pointer, or null if there is none.
json find(const json& in, const char* pointer) {
  const json::json_pointer place(pointer);
  return in.contains(place) ? in[place] : json();
}

// Returns one line per input (a file, or a class in Python) that both configurations have and that
// has changed. Removes these inputs from both.
std::vector<std::string> take_changed_inputs(json& recorded, json& now) {
  std::vector<std::string> changes;
  const json before = find(recorded, "/inputs");
  for (const auto& [name, hash] : before.items()) {
    json& current = now["inputs"];
    if (before.is_object() && hash.is_string() && current.contains(name) && current[name] != hash) {
      changes.push_back(fmt::format(
          "the input '{}' has changed since the run began (SHA-256: recorded {}, now {})",
          sanitize(name), sanitize(hash.dump().substr(0, 66)), current[name].dump()));
      current.erase(name);
      recorded["inputs"].erase(name);
    }
  }
  return changes;
}

// Removes what differs only because something else does: the problem's budget, if the run's budget
// differs, and the SIMD level, if one of the two engines has none.
void remove_consequences(json& recorded, json& now) {
  const auto differs = [&](const char* pointer) {
    return find(recorded, pointer) != find(now, pointer);
  };
  const auto remove = [&](const char* table, const char* key) {
    for (json* one : {&recorded, &now}) {
      if (find(*one, table).is_object()) {
        (*one)[json::json_pointer(table)].erase(key);
      }
    }
  };
  remove("/problem/run", "optimizer");  // the default, which the run need not have
  if (differs("/run/budget")) {
    remove("/problem/run", "budget");
  }
  const bool one_has_none = find(recorded, "/problem/physics/simd").is_null() !=
                            find(now, "/problem/physics/simd").is_null();
  if (one_has_none && differs("/problem/physics/engine")) {
    remove("/problem/physics", "simd");
  }
}

// Returns one line per difference of the configurations. Empty if they are the same.
std::vector<std::string> list_changes(json recorded, json now) {
  std::vector<std::string> changes = take_changed_inputs(recorded, now);
  remove_consequences(recorded, now);
  std::ranges::copy(describe_differences(recorded.dump(), now.dump()), std::back_inserter(changes));
  return changes;
}

// Returns a line with the command that began the run or continued it with a larger budget, or an
// empty text if none is recorded.
std::string describe_command(const json& manifest) {
  try {
    const auto words = manifest.value("command_line", std::vector<std::string>());
    return words.empty()
               ? ""
               : "\nThe run was begun or continued with:\n  " + sanitize(quote_command(words));
  } catch (const json::exception&) {
    return "";  // a damaged one does not prevent the list of differences
  }
}

// Returns the configuration with the budget of the recorded one, and with the pace with which the
// recorded run began (keep_pace()).
json take_recorded_budget(const json& recorded, json now, const OptimizerRow& optimizer) {
  for (const char* const pointer : {"/run/budget", "/problem/run/budget"}) {
    const json::json_pointer place(pointer);
    if (recorded.contains(place) && now.contains(place)) {
      now[place] = recorded[place];
    }
  }
  const std::string& pace = optimizer.pace_option;
  json& options = now["run"]["options"];
  const json before = find(recorded, "/run/options");
  options.erase(pace);
  if (!pace.empty() && before.contains(pace)) {
    options[pace] = before[pace];
  }
  return now;
}

// Returns advice if the budgets differ, else an empty text.
std::string explain_budget(std::int64_t recorded, const RunPlan& plan) {
  if (recorded > plan.budget) {
    return "\nA larger budget can continue a run, and a smaller one cannot";
  }
  const std::string why = recorded < plan.budget ? explain_no_continuation(plan) : "";
  return why.empty() ? "" : "\nThe larger budget does not continue this run: " + why;
}

}  // namespace

RunFolder::RunFolder(const std::filesystem::path& path, const std::filesystem::path& root,
                     const RunPlan& plan, std::span<const std::string> command_line)
    : folder_(claim_folder(path, root)), lock_(take_lock(folder_, obstacle_)) {
  const auto file = path / "manifest.json";
  if (!path_exists(file)) {
    const std::string text = make_manifest(plan, command_line).dump(2) + "\n";
    FolderChecksums checksums(folder_);
    checksums.cover(file.filename().string(), text);
    checksums.save();
    write_file_atomically(folder_, file.filename().string(), text);
    return;
  }
  const json manifest = read_manifest(file);
  has_checksums_ = manifest["has_checksums"].get<bool>();
  const json& recorded = manifest["configuration"];
  const json now = json::parse(to_json(plan));
  std::vector<std::string> changes = list_changes(recorded, now);
  const json budget = find(recorded, "/run/budget");
  const std::int64_t before = budget.is_number_integer() ? budget.get<std::int64_t>() : plan.budget;
  if (before < plan.budget && explain_no_continuation(plan).empty() &&
      list_changes(recorded, take_recorded_budget(recorded, now, plan.optimizer)).empty()) {
    changes.clear();
    continued_budget_ = before;
    budget_ = plan.budget;
    json larger = manifest;
    const json words = make_manifest(plan, command_line);
    larger["configuration"] = words["configuration"];
    larger["command_line"] = words["command_line"];
    manifest_ = larger.dump(2) + "\n";
  }
  if (!changes.empty()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{} holds a run with another configuration:\n  {}{}\nResume it with the "
                    "recorded configuration, or use --new or --out for another folder{}{}",
                    path.string(), join(changes, "\n  "), describe_command(manifest),
                    explain_budget(before, plan), explain_simd(recorded, now)));
  }
  warnings_ =
      describe_build_changes(manifest["build"].get<std::map<std::string, std::string>>(), "run");
}

void RunFolder::check_writable() const {
  if (!obstacle_.empty()) {
    throw Error(ErrorKind::io, obstacle_);
  }
}

void RunFolder::record_larger_budget(Journal& journal, std::uint64_t evaluations) const {
  FolderChecksums checksums(folder_);
  std::vector<std::string> changing = {"journal"};
  for (const auto& [name, sha256] : checksums.lines()) {
    if (is_derived_file(name)) {
      changing.push_back(name);
    }
  }
  checksums.drop(changing);
  for (const std::string& name : derived_file_names()) {
    folder_.remove(name);
  }
  journal.append(ContinueRecord{static_cast<std::uint64_t>(budget_), evaluations});
  const std::pair<std::string, std::string> manifest("manifest.json", manifest_);
  checksums.write({&manifest, 1});
  checksums.save();
}

const std::vector<std::string>& derived_file_names() {
  static const std::vector<std::string> names = {"result.json",
                                                 "winner.toml",
                                                 "front.csv",
                                                 "convergence.csv",
                                                 "winner-trajectory.csv",
                                                 "winner-record.csv",
                                                 "results.sqlite",
                                                 "cell.json",
                                                 kCheckFile,
                                                 kPlantFile,
                                                 kIdentificationFile};
  return names;
}

bool is_derived_file(const std::string& name) {
  return std::ranges::count(derived_file_names(), name) > 0 || name.starts_with(kWinnerFiles);
}

bool is_of_version_1(const nlohmann::json& manifest) {
  const json selection = find(manifest, "/configuration/run/selection");
  return selection.is_object() && !selection.contains("most");
}

void cover_run(const Folder& folder, bool has_ended) {
  FolderChecksums checksums(folder);
  checksums.cover("manifest.json");
  if (has_ended) {
    checksums.cover("journal");
  }
  for (const std::string& name : derived_file_names()) {
    checksums.cover(name);
  }
  checksums.save();
}

void keep_pace(const std::filesystem::path& folder, RunPlan& plan) {
  const std::string& pace = plan.optimizer.pace_option;
  const auto file = folder / "manifest.json";
  if (pace.empty() || plan.options.get_integer(pace) != 0 || !path_exists(file)) {
    return;
  }
  const json manifest = read_manifest(file);
  const json recorded = find(manifest, "/configuration/run");
  const json options = find(recorded, "/options");
  const json before = options.is_object() ? options.value(pace, json(0)) : json(0);
  const json budget = find(recorded, "/budget");
  if (find(recorded, "/optimizer") != plan.optimizer.name || !before.is_number_integer() ||
      !budget.is_number_integer()) {
    return;
  }
  auto evaluations = before.get<std::int64_t>();
  if (evaluations == 0 && budget.get<std::int64_t>() < plan.budget) {
    evaluations = budget.get<std::int64_t>() / plan.schedule.cases;
  }
  if (evaluations == 0) {
    return;
  }
  std::vector<std::string> texts = {fmt::format("{}={}", pace, evaluations)};
  for (const auto& [name, value] : plan.options.values()) {
    if (name != pace) {
      texts.push_back(name + "=" + to_text(value));
    }
  }
  plan.options = Options::parse(plan.optimizer.name, plan.optimizer.options, texts);
}

namespace {

// Calls `read` with the recorded configuration of a run.
void read_configuration(const std::filesystem::path& folder,
                        const std::function<void(const json& configuration)>& read) {
  const auto file = folder / "manifest.json";
  if (!path_exists(file)) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is not the folder of a run (it has no manifest.json)",
                            sanitize(folder.string())));
  }
  const json manifest = read_manifest(file);
  try {
    read(manifest.at("configuration"));
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a manifest that armwright wrote ({})",
                            sanitize(file.string()), describe_json_error(error.what())));
  }
}

}  // namespace

LoadedProblem load_problem_of_run(const std::filesystem::path& folder) {
  LoadedProblem problem;
  read_configuration(folder, [&](const json& configuration) {
    problem = load_recorded_problem(configuration.at("problem").dump(), "problem", folder);
  });
  return problem;
}

RunPlan load_recorded_plan(const std::filesystem::path& folder) {
  RunPlan plan;
  plan.problem = load_problem_of_run(folder);
  read_configuration(folder, [&](const json& configuration) {
    const json& run = configuration.at("run");
    const auto optimizer = run.at("optimizer").get<std::string>();
    std::vector<std::string> options;
    for (const auto& [name, value] : run.at("options").items()) {
      options.push_back(name + "=" + (value.is_string() ? value.get<std::string>() : value.dump()));
    }
    const bool writes = std::ranges::any_of(
        options, [](const std::string& one) { return one.starts_with("log="); });
    if (is_plugin(optimizer) || writes) {
      throw Error(
          ErrorKind::usage,
          fmt::format("the run in {} would run, with all of your rights: {}{}. If you trust "
                      "it, name --problem, --optimizer and --budget as when the run began",
                      sanitize(folder.string()), sanitize(optimizer),
                      writes ? ", which writes to a file (log=)" : ""));
    }
    plan.optimizer = load_optimizer(optimizer);
    plan.options = Options::parse(plan.optimizer.name, plan.optimizer.options, options);
    plan.seed = run.at("seed").get<std::uint64_t>();
    plan.budget = run.at("budget").get<std::int64_t>();
    plan.schedule = read_recorded_schedule(run.at("schedule"));
    const json& selection = run.at("selection");
    plan.selection = {.last = selection.at("last").get<int>(),
                      .best = selection.at("best").get<int>(),
                      .most = selection.at("most").get<int>(),
                      .evaluated_only = selection.value("evaluated_only", false)};
  });
  return plan;
}

std::filesystem::path choose_run_folder(const std::filesystem::path& parent,
                                        const std::string& name, bool fresh) {
  std::filesystem::path folder = parent / name;
  for (int number = 2; fresh && path_exists(folder); ++number) {
    folder = parent / fmt::format("{}-{:03}", name, number);
  }
  return folder;
}

}  // namespace armwright
