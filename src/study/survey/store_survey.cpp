#include "study/survey/store_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "study/compare/study_folder.hpp"
#include "study/compare/study_plan.hpp"
#include "study/run/run_lock.hpp"
#include "study/survey/derived_survey.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kStudyRecord = "study.toml";
constexpr const char* kReproductionRecord = "reproduction.json";

bool is_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

// Returns the folders in it, sorted, without links and without folders that a repair set aside.
std::vector<std::filesystem::path> list_folders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> folders;
  for (const auto& path : list_folder(folder)) {
    std::error_code ignored;
    if (std::filesystem::is_directory(std::filesystem::symlink_status(path, ignored)) &&
        !path.filename().string().ends_with(".damaged")) {
      folders.push_back(path);
    }
  }
  return folders;
}

void find_runs(const std::filesystem::path& folder, int depth,
               std::vector<std::filesystem::path>& runs) {
  constexpr int kMostDepth = 6;  // STUDY/reruns/PROBLEM/OPTIMIZER/rNN
  for (const auto& one : list_folders(folder)) {
    if (is_run_folder(one)) {
      runs.push_back(one);
    } else if (depth < kMostDepth) {
      find_runs(one, depth + 1, runs);
    }
  }
}

[[noreturn]] void refuse(const std::filesystem::path& folder) {
  const std::string shown = sanitize(folder.string());
  if (!is_there(folder)) {
    throw Error(ErrorKind::usage, fmt::format("there is no folder '{}'", shown));
  }
  if (!is_folder(folder)) {
    throw Error(ErrorKind::usage,
                fmt::format("'{}' is not a folder; name the folder of a run, a study or a "
                            "reproduction",
                            shown));
  }
  std::vector<std::string> inside;
  for (const auto& one : list_folders(folder)) {
    if (is_run_folder(one) || is_there(one / kStudyRecord) || is_there(one / kReproductionRecord)) {
      inside.push_back(sanitize(one.filename().string()));
    }
  }
  throw Error(
      ErrorKind::usage,
      fmt::format("{}: is not the folder of a run (it has no manifest.json), a study (no {}) or a "
                  "reproduction (no {}){}",
                  shown, kStudyRecord, kReproductionRecord,
                  inside.empty() ? "" : "; name one of those in it: " + join(inside, ", ")));
}

class StoreSurveyor {
 public:
  explicit StoreSurveyor(const std::filesystem::path& folder) { survey_.folder = folder; }

  StoreSurvey run() {
    const auto& folder = survey_.folder;
    if (is_there(folder / kStudyRecord) || is_folder(folder / "cells")) {
      survey_.kind = StoreSurvey::Kind::study;
    } else if (is_there(folder / kReproductionRecord)) {
      survey_.kind = StoreSurvey::Kind::reproduction;
    } else if (!is_run_folder(folder)) {
      refuse(folder);
    }
    std::vector<std::filesystem::path> runs = {folder};
    if (survey_.kind != StoreSurvey::Kind::run) {
      survey_.writer = find_writer(folder);
      runs.clear();
      find_runs(folder, 0, runs);
    }
    for (const auto& one : runs) {
      const auto name = survey_.kind == StoreSurvey::Kind::run ? std::filesystem::path(".")
                                                               : one.lexically_relative(folder);
      survey_.runs.push_back(survey_run(one, name));
    }
    switch (survey_.kind) {
      case StoreSurvey::Kind::run:
        survey_.writer = survey_.runs.front().writer;
        survey_.is_record_lost = survey_.runs.front().is_manifest_lost;
        break;
      case StoreSurvey::Kind::study:
        check_study();
        break;
      case StoreSurvey::Kind::reproduction:
        check_record(kReproductionRecord, find_json_fault);
        break;
    }
    if (survey_.kind != StoreSurvey::Kind::run && survey_.writer.empty()) {
      check_checksums();
    }
    std::ranges::stable_sort(survey_.findings, {}, &Finding::file);
    return std::move(survey_);
  }

 private:
  std::string find_fault(const std::filesystem::path& file, auto find) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      return is_there(file) ? "it is not a regular file" : "it is missing";
    }
    check_readable(file);
    try {
      return find(file);
    } catch (const std::exception& error) {
      return sanitize(error.what());
    }
  }

  void check_record(const char* name, auto find) {
    const std::string fault = find_fault(survey_.folder / name, find);
    if (!fault.empty()) {
      survey_.is_record_lost = true;
      survey_.findings.push_back({Finding::Kind::loss, name, fault});
    }
  }

  void check_study() {
    check_record(kStudyRecord, [&](const std::filesystem::path& file) {
      const std::string fault = find_toml_fault(file);
      if (fault.empty()) {
        if (!ConfigTable::load(file).has("plan_sha256")) {
          return std::string("it has no plan_sha256, so it is not the plan that began this study");
        }
        check_plan_hash(file);
        survey_.planned_cells = count_cells(file);
      }
      return fault;
    });
    for (const RunSurvey& run : survey_.runs) {
      const bool is_cell = run.name.string().starts_with("cells/");
      const bool has_cell = is_there(survey_.folder / run.name / "cell.json") &&
                            !std::ranges::count(run.damaged_files, "cell.json");
      survey_.finished_cells += is_cell && has_cell ? 1 : 0;
    }
    if (survey_.writer.empty()) {
      check_derived();
    }
  }

  static std::size_t count_cells(const std::filesystem::path& file) {
    const json plan = json::parse(ConfigTable::load(file).to_json());
    return plan.at("problem").size() * plan.at("optimizer").size() *
           plan.at("replicates").get<std::size_t>();
  }

  // Checks the files that are derived from the study's plan and cells.
  void check_derived() {
    const auto check = [&](const std::filesystem::path& name, auto find) {
      const std::string fault = find_fault(survey_.folder / name, find);
      if (!fault.empty()) {
        survey_.findings.push_back({Finding::Kind::damage, name, fault});
        survey_.damaged_files.push_back(name);
      }
    };
    for (const char* part : {"problems", "tables", "final"}) {
      if (!is_folder(survey_.folder / part)) {
        continue;
      }
      for (const auto& path : list_tree(survey_.folder / part)) {
        const auto name = path.lexically_relative(survey_.folder);
        if (name.extension() == ".json") {
          check(name, find_json_fault);
        } else if (name.extension() == ".csv") {
          check(name, [](const auto& csv) { return find_csv_fault(csv); });
        }
      }
    }
    if (is_there(survey_.folder / "result.json")) {
      check("result.json", find_json_fault);
      if (!is_there(survey_.folder / "verdict.txt")) {
        survey_.findings.push_back(
            {Finding::Kind::note, "verdict.txt",
             "it is missing; the command that began the study makes it again"});
      }
    } else if (survey_.planned_cells > 0 && survey_.finished_cells == survey_.planned_cells) {
      survey_.findings.push_back(
          {Finding::Kind::note, "result.json",
           "it is missing; the command that began the study makes it again"});
    }
  }

  // Returns the runs that belong to the study or reproduction; STUDY/reruns does not.
  static bool is_member(const RunSurvey& run) {
    const std::string folder = run.name.begin()->string();
    return folder == "cells" || folder == "runs";
  }

  void add_damage(const std::string& name, const std::string& what) {
    survey_.findings.push_back({Finding::Kind::damage, name, what});
    if (std::ranges::count(survey_.damaged_files, std::filesystem::path(name)) == 0) {
      survey_.damaged_files.emplace_back(name);
    }
  }

  RunSurvey* find_run(const std::string& checksums) {
    const auto found = std::ranges::find(
        survey_.runs, std::filesystem::path(checksums).parent_path(), &RunSurvey::name);
    return std::filesystem::path(checksums).filename() == kChecksumFile &&
                   found != survey_.runs.end()
               ? &*found
               : nullptr;
  }

  void check_checksums() {
    const std::string record =
        survey_.kind == StoreSurvey::Kind::study ? kStudyRecord : kReproductionRecord;
    std::vector<std::string> expected = {record};
    if (survey_.kind == StoreSurvey::Kind::study) {
      expected = list_study_files(survey_.folder);
    }
    // A study covers its cells when its tables are written.
    const bool has_tables = is_there(survey_.folder / "result.json");
    bool has_new_run = false;
    for (const RunSurvey& run : survey_.runs) {
      has_new_run = has_new_run || (is_member(run) && run.has_checksums);
      const bool is_complete = survey_.kind == StoreSurvey::Kind::study
                                   ? has_tables && is_there(survey_.folder / run.name / "cell.json")
                                   : run.state == RunSurvey::State::finished;
      if (is_member(run) && is_complete && is_there(survey_.folder / run.name / kChecksumFile)) {
        expected.push_back((run.name / kChecksumFile).string());
      }
    }
    const ChecksumSurvey found = survey_checksums(survey_.folder, expected);
    if (!found.fault.empty()) {
      add_damage(kChecksumFile, found.fault);
      return;
    }
    if (!found.is_there && has_new_run) {
      add_damage(kChecksumFile, "it is missing; the command that began the " +
                                    std::string(to_string(survey_.kind)) + " writes it again");
    } else if (found.is_there && !found.lines.contains(record)) {
      add_damage(kChecksumFile, "it does not list " + record);
    } else if (!found.uncovered.empty()) {
      survey_.findings.push_back(
          {Finding::Kind::note, kChecksumFile,
           fmt::format("{}, so nothing covers {}",
                       found.is_there ? "it has no line for some files"
                                      : "there is none, as in folders of version 1.0",
                       join(found.uncovered, ", "))});
    }
    for (const auto& [name, change] : found.changed) {
      if (std::ranges::count(survey_.findings, std::filesystem::path(name), &Finding::file) > 0) {
        continue;  // the other checks say more of it
      }
      if (name == record) {
        survey_.is_record_lost = true;
        survey_.findings.push_back({Finding::Kind::loss, name, change});
      } else if (RunSurvey* run = find_run(name)) {
        run->findings.push_back({Finding::Kind::damage, kChecksumFile, change});
        run->damaged_files.emplace_back(kChecksumFile);
      } else {
        add_damage(name, change);
      }
    }
    for (const std::string& name : found.missing) {
      const RunSurvey* run = find_run(name);
      const bool is_named =
          std::ranges::count(survey_.findings, std::filesystem::path(name), &Finding::file) > 0;
      if (!is_named && (run == nullptr || !run->has_checksums)) {
        survey_.findings.push_back({Finding::Kind::note, name,
                                    "it is missing; the command that began the " +
                                        std::string(to_string(survey_.kind)) + " makes it again"});
      }
    }
  }

  StoreSurvey survey_;
};

}  // namespace

const char* to_string(StoreSurvey::Kind kind) {
  switch (kind) {
    case StoreSurvey::Kind::run:
      return "run";
    case StoreSurvey::Kind::study:
      return "study";
    case StoreSurvey::Kind::reproduction:
      return "reproduction";
  }
  return "?";
}

bool StoreSurvey::is_damaged() const {
  return std::ranges::any_of(
             findings,
             [](const Finding& finding) { return finding.kind != Finding::Kind::note; }) ||
         std::ranges::any_of(runs, &RunSurvey::is_damaged);
}

StoreSurvey survey_store(const std::filesystem::path& folder) {
  return StoreSurveyor(folder).run();
}

std::vector<std::string> make_command(const StoreSurvey& survey, const std::string& program,
                                      const std::filesystem::path& folder) {
  switch (survey.kind) {
    case StoreSurvey::Kind::study:
      return {program, "compare", (folder / kStudyRecord).string(), "--out", folder.string()};
    case StoreSurvey::Kind::reproduction:
      return {program, "reproduce", "--out", folder.string()};
    case StoreSurvey::Kind::run:
      break;
  }
  if (survey.runs.front().is_asked) {
    return {program, "ask", folder.string()};
  }
  const auto& recorded = survey.runs.front().command_line;
  if (recorded.size() < 2) {
    return {};
  }
  std::vector<std::string> words = {program};
  for (auto word = recorded.begin() + 1; word != recorded.end(); ++word) {
    if (*word == "--out") {
      if (word + 1 != recorded.end()) {
        ++word;
      }
    } else if (*word != "--new" && !word->starts_with("--out=")) {
      words.push_back(*word);
    }
  }
  words.insert(words.end(), {"--out", folder.string()});
  return words;
}

std::string advise_on_lost_record(const StoreSurvey& survey, const std::string& program) {
  const std::string folder = sanitize(survey.folder.string());
  if (survey.kind == StoreSurvey::Kind::study) {
    return fmt::format(
        "What was compared is recorded in study.toml alone, and no repair brings it back. To keep "
        "the cells: begin the same comparison in a new folder ({} compare FILE --out NEW, with the "
        "file or flags of then), stop it with Ctrl-C, copy {}/cells over NEW/cells and give the "
        "same command again: cells of another plan are refused.",
        program, folder);
  }
  if (survey.kind == StoreSurvey::Kind::reproduction) {
    return fmt::format(
        "What was computed of the winners is recorded in reproduction.json alone, and no repair "
        "brings it back. To keep the runs: begin it in a new folder ({} reproduce --out NEW), stop "
        "it with Ctrl-C, copy {}/runs to NEW/runs and give the same command again.",
        program, folder);
  }
  const RunSurvey& run = survey.runs.front();
  return fmt::format(
      "What the run was begun with is recorded in manifest.json alone, and no repair brings it "
      "back. To keep its evaluations: begin the same run in a new folder ({} optimize {} --out "
      "NEW, "
      "with the options of then{}), stop it with Ctrl-C, copy {}/journal over NEW/journal and give "
      "the same command again: every evaluation is compared with what the optimizer asks for. "
      "winner.toml, the tables and results.sqlite can be used as they are.",
      program, run.made_by.empty() ? "PROBLEM" : run.made_by,
      run.made_by.empty() ? "" : "; problem, optimizer and seed are those of result.json", folder);
}

}  // namespace armwright
