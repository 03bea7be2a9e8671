#include "study/survey/run_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/cell.hpp"
#include "study/run/json_values.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_lock.hpp"
#include "study/run/run_times.hpp"
#include "study/survey/derived_survey.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Returns the fault that `check` finds in a file, or the error that prevents the check. Rights that
// forbid to read the file are no fault of it: then this function throws Error{io}.
std::string find_fault(const std::filesystem::path& file,
                       const std::function<std::string()>& check) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return error ? fmt::format("it cannot be read: {}", error.message())
                 : "it is not a regular file";
  }
  check_readable(file);
  try {
    return check();
  } catch (const Error& failure) {
    return sanitize(failure.what());
  }
}

class RunSurveyor {
 public:
  RunSurveyor(const std::filesystem::path& folder, const std::filesystem::path& name)
      : folder_(folder) {
    survey_.name = name;
    survey_.writer = find_writer(folder);
  }

  RunSurvey run() {
    check_manifest();
    load_result();
    check_journal();
    check_leftovers();
    // While a process writes the run, its derived files may belong to an earlier state.
    if (survey_.writer.empty()) {
      compare_result();
      if (result_) {
        check_tables();
      }
      check_cell();
    }
    check_times();
    check_checksums();
    return std::move(survey_);
  }

 private:
  void add(Finding::Kind kind, const std::string& file, std::string what) {
    survey_.findings.push_back({kind, file, std::move(what)});
  }

  void add_damaged_file(const std::string& file, std::string what) {
    add(Finding::Kind::damage, file, std::move(what));
    if (std::ranges::count(survey_.damaged_files, file) == 0) {
      survey_.damaged_files.push_back(file);
    }
  }

  void check_manifest() {
    const auto file = folder_ / "manifest.json";
    std::string fault = "it is missing";
    if (is_there(file)) {
      fault = find_fault(file, [&] { return read_manifest(file); });
    }
    if (!fault.empty()) {
      survey_.is_manifest_lost = true;
      add(Finding::Kind::loss, "manifest.json", fault);
    }
  }

  std::string read_manifest(const std::filesystem::path& file) {
    try {
      const json manifest = json::parse(read_json_file(file, kManifestLimit_bytes));
      if (manifest.at("format") != kManifestFormat) {
        return "its format is not the one that this version reads";
      }
      if (is_of_version_1(manifest)) {
        return kIsOfVersion1;
      }
      for (const char* key : {"problem", "run"}) {
        if (!manifest.at("configuration").at(key).is_object()) {
          return fmt::format("its configuration has no {}", key);
        }
      }
      if (!manifest.at("build").is_object()) {
        return "it does not say what build began the run";
      }
      survey_.command_line = manifest.value("command_line", std::vector<std::string>());
      survey_.has_checksums = manifest.value("has_checksums", false);
      const json& run = manifest["configuration"]["run"];
      recorded_optimizer_ = run.value("optimizer", std::string());
      recorded_seed_ = run.value("seed", json());
      survey_.is_asked = is_asked_run(run);
    } catch (const json::exception& error) {
      return fmt::format("it is not one that armwright wrote ({})",
                         describe_json_error(error.what()));
    }
    return "";
  }

  void load_result() {
    const auto file = folder_ / "result.json";
    if (!is_there(file)) {
      return;
    }
    const std::string fault = find_fault(file, [&] {
      const std::string text = read_file(file, kResultLimit_bytes);
      const RunResult& result = result_.emplace(parse_result(text, file)).result();
      if (std::string difference = find_summary_difference(text, result); !difference.empty()) {
        return difference;
      }
      if (!survey_.is_manifest_lost &&
          (recorded_optimizer_ != result.optimizer || recorded_seed_ != result.seed)) {
        return fmt::format("it is of optimizer {} with seed {}, and manifest.json is of {} with {}",
                           result.optimizer, result.seed, recorded_optimizer_,
                           recorded_seed_.dump());
      }
      return std::string();
    });
    if (!fault.empty()) {
      // The advice of parse_result() is for a user who has not run this check.
      add_damaged_file("result.json", fault.substr(0, fault.find(". To rebuild it")));
    }
    if (!result_) {
      return;
    }
    const RunResult& result = result_->result();
    survey_.state = result.failure.empty() ? RunSurvey::State::finished : RunSurvey::State::failed;
    const std::vector<std::string> words = {result.problem, "--optimizer", result.optimizer,
                                            "--seed", std::to_string(result.seed)};
    survey_.made_by = sanitize(quote_command(words));
  }

  void check_journal() {
    const auto file = folder_ / "journal";
    if (!is_there(file)) {
      if (result_) {
        survey_.is_journal_unreadable = true;
        survey_.lost = result_->result().counts.evaluations;
        add(Finding::Kind::damage, "journal", "it is missing, and with it every evaluation");
      }
      return;
    }
    const std::string fault = find_fault(file, [&] {
      survey_.journal = survey_journal(file, [&](const EvaluationRecord& record) {
        if (result_) {
          result_->add(record);
        }
      });
      return "";
    });
    if (!fault.empty()) {
      survey_.is_journal_unreadable = true;
      survey_.lost = result_ ? result_->result().counts.evaluations : 0;
      add(Finding::Kind::damage, "journal", fault);
      return;
    }
    describe_journal(*survey_.journal);
  }

  void describe_journal(const JournalSurvey& journal) {
    const auto damage = [&](std::string what) {
      add(Finding::Kind::damage, "journal", std::move(what));
    };
    constexpr std::size_t kMostNamedLines = 20;
    for (std::size_t i = 0; i < journal.damage.size(); ++i) {
      if (i == kMostNamedLines) {
        damage(
            fmt::format("and {} more damaged stretches", journal.damage.size() - kMostNamedLines));
        break;
      }
      const DamagedStretch& stretch = journal.damage[i];
      damage(
          fmt::format("byte {}, {} bytes: record {} is damaged: {}; {} intact before "
                      "it, {} behind it",
                      stretch.offset, stretch.bytes, stretch.records_before + 1, stretch.fault,
                      stretch.records_before, stretch.records_behind));
    }
    for (const std::uint64_t index : journal.contradictory) {
      damage(
          fmt::format("evaluation {} is recorded more than once with different content; none "
                      "of its records is used",
                      index));
    }
    if (const std::size_t count = journal.contradictory_judgements.size(); count > 0) {
      damage(
          fmt::format("{} designs are judged more than once on the same cases with different "
                      "results; none of these records is used",
                      count));
    }
    const std::size_t lost_judgements = result_ ? result_->count_lost_judgements() : 0;
    if (lost_judgements > 0) {
      damage(fmt::format("lost: {} of the judgements that result.json has", lost_judgements));
    } else if (journal.lacks_test()) {
      damage("lost: the winner's test, though the run has ended");
    }
    if (journal.repeated_judgements > 0) {
      add(Finding::Kind::note, "journal",
          fmt::format("{} judgements are recorded more than once with equal content",
                      journal.repeated_judgements));
    }
    if (journal.records_behind_end > 0) {
      damage(
          fmt::format("{} records follow the one that ends the run", journal.records_behind_end));
    }
    const auto lost = journal.list_lost();
    survey_.lost = count(lost) + journal.contradictory.size();
    if (!lost.empty()) {
      damage(fmt::format("lost: {} of {} evaluations ({})", count(lost),
                         count(lost) + journal.evaluations.size(), describe(lost)));
    }
    if (const auto gaps = journal.list_gaps(); !gaps.empty() && survey_.writer.empty()) {
      add(Finding::Kind::note, "journal",
          fmt::format("evaluations {} are not in it, because of an interruption or a repair; "
                      "they are made again",
                      describe(gaps)));
    }
    if (journal.repeated > 0) {
      add(Finding::Kind::note, "journal",
          fmt::format("{} evaluations are recorded more than once with equal content",
                      journal.repeated));
    }
    if (journal.torn_bytes > 0) {
      add(Finding::Kind::note, "journal",
          survey_.writer.empty()
              ? fmt::format("byte {}, {} bytes at its end are an incomplete record, as a kill or a "
                            "power cut leaves it; resuming the run removes them",
                            journal.torn_offset, journal.torn_bytes)
              : fmt::format("byte {}, {} bytes at its end are being written", journal.torn_offset,
                            journal.torn_bytes));
    }
  }

  // If they differ and the journal is complete, the journal is right.
  void compare_result() {
    if (!result_) {
      if (survey_.journal && survey_.journal->end && !survey_.journal->is_damaged() &&
          !is_there(folder_ / "result.json")) {
        add(Finding::Kind::note, "result.json",
            "it is missing, though the run has ended; the command that began the run makes it "
            "again from the journal");
      }
      return;
    }
    if (!survey_.journal) {
      return;
    }
    const JournalSurvey& journal = *survey_.journal;
    const std::string difference = result_->find_difference(journal);
    const std::uint64_t all = result_->result().counts.evaluations;
    const std::uint64_t there = journal.evaluations.size() - journal.contradictory.size();
    survey_.lost = std::max(survey_.lost, all - std::min(all, there));
    const bool must_end = result_->result().failure.empty();
    if (journal.end && result_->count_lost_judgements() > 0) {
      return;  // described with the journal
    }
    if (difference.empty() && (journal.end || !must_end || journal.is_damaged())) {
      return;
    }
    if (journal.end && !journal.is_damaged()) {
      add_damaged_file("result.json", "it is not what the journal says: " + difference);
    } else if (!journal.is_damaged()) {
      add(Finding::Kind::damage, "journal",
          fmt::format("its end is missing: result.json is of a whole run{}",
                      difference.empty() ? "" : "; " + difference));
    }
  }

  void check_tables() {
    const RunResult& result = result_->result();
    const auto check = [&](const std::string& name, const auto& find) {
      const auto file = folder_ / name;
      if (is_there(file)) {
        const std::string fault = find_fault(file, [&] { return find(file); });
        if (!fault.empty()) {
          add_damaged_file(name, fault);
        }
      }
    };
    check("winner.toml", result.tracking ? find_design_fault : find_values_fault);
    const auto find_row_fault = [](const auto& file) { return find_csv_fault(file); };
    check("front.csv", find_row_fault);
    check("winner-trajectory.csv", find_row_fault);
    check("winner-record.csv", find_row_fault);
    // If a failed run is tried again, its journal may have more evaluations than its result.
    const bool is_known =
        survey_.journal && !survey_.journal->is_damaged() && result.failure.empty();
    const auto last = is_known ? result_->calc_last_row() : std::nullopt;
    check("convergence.csv", [&](const auto& file) { return find_csv_fault(file, last); });
    check("results.sqlite",
          [&](const std::filesystem::path& file) { return find_database_fault(file, result); });
  }

  void check_cell() {
    const auto file = folder_ / "cell.json";
    if (!is_there(file)) {
      return;
    }
    const std::string fault = find_fault(file, [&]() -> std::string {
      const CellOutcome cell = parse_cell(read_file(file, kCellLimit_bytes), file);
      return result_ ? find_cell_difference(cell, result_->result(), survey_.name) : "";
    });
    if (!fault.empty()) {
      add_damaged_file("cell.json", fault);
    }
  }

  // No result depends on this file, so its damage is only a note.
  void check_times() {
    try {
      load_times(folder_);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::bad_data) {
        throw;
      }
      add(Finding::Kind::note, kTimesFile,
          "it is damaged, so pages show no time taken; the next life of the run replaces it");
    }
  }

  // Returns the files of the run that checksums should cover. A journal grows until its run ends.
  std::vector<std::string> list_complete_files() const {
    std::vector<std::string> names = {"manifest.json"};
    if (survey_.journal && survey_.journal->end) {
      names.emplace_back("journal");
    }
    names.insert(names.end(), derived_file_names().begin(), derived_file_names().end());
    std::erase_if(names, [&](const std::string& name) { return !is_there(folder_ / name); });
    return names;
  }

  void check_checksums() {
    ChecksumSurvey found;
    const auto file = folder_ / kChecksumFile;
    const std::string fault = find_fault(is_there(file) ? file : folder_ / "manifest.json", [&] {
      found = survey_checksums(folder_, list_complete_files());
      return found.fault;
    });
    const bool has_manifest = is_there(folder_ / "manifest.json");
    if (!fault.empty()) {
      if (has_manifest) {
        add_damaged_file(kChecksumFile, fault);
      }
      return;
    }
    if (!found.is_there && survey_.has_checksums) {
      add_damaged_file(kChecksumFile,
                       "it is missing; the command that began the run writes it again");
    } else if (found.is_there && has_manifest && !found.lines.contains("manifest.json")) {
      // A kill while a larger budget is recorded leaves the new manifest without its line.
      if (survey_.journal && survey_.journal->is_continued) {
        add(Finding::Kind::note, kChecksumFile,
            "it does not list manifest.json, because a kill has interrupted the start with a "
            "larger "
            "budget; it does so when the run ends");
      } else {
        add_damaged_file(kChecksumFile, "it does not list manifest.json");
      }
    } else if (!found.uncovered.empty() && survey_.writer.empty()) {
      add(Finding::Kind::note, kChecksumFile,
          fmt::format("{}, so nothing covers {}",
                      found.is_there ? "it has no line for some files"
                                     : "there is none, as in runs of version 1.0",
                      join(found.uncovered, ", ")));
    }
    add_changes(found);
  }

  // Does not name a file twice: what the other checks say of it is more than that it has changed.
  void add_changes(const ChecksumSurvey& found) {
    const auto is_named = [&](const std::string& name) {
      return std::ranges::any_of(survey_.findings, [&](const Finding& finding) {
        return finding.file == name && finding.kind != Finding::Kind::note;
      });
    };
    for (const auto& [name, change] : found.changed) {
      if (is_named(name)) {
        continue;
      }
      if (name == "manifest.json") {
        survey_.is_manifest_lost = true;
        add(Finding::Kind::loss, name, change);
      } else if (!survey_.writer.empty()) {
        continue;  // the process may be replacing it
      } else if (is_derived_file(name)) {
        add_damaged_file(name, change);
      } else {
        add(Finding::Kind::damage, name, change);
      }
    }
    for (const std::string& name : found.missing) {
      if (std::ranges::count(survey_.findings, std::filesystem::path(name), &Finding::file) > 0) {
        continue;
      }
      if (is_derived_file(name)) {
        if (survey_.writer.empty()) {
          add(Finding::Kind::note, name,
              "it is missing; the command that began the run makes it again");
        }
      } else if (name == "journal" && !result_) {
        survey_.is_journal_unreadable = true;
        add(Finding::Kind::damage, name, "it is missing, and with it every evaluation");
      } else if (name != "journal" && name != "manifest.json") {
        add_damaged_file(kChecksumFile,
                         fmt::format("it lists '{}', which no run has", sanitize(name)));
      }
    }
  }

  void check_leftovers() {
    for (const auto& entry : list_folder(folder_)) {
      const std::string name = entry.filename().string();
      if (name.ends_with(".new")) {
        if (survey_.writer.empty()) {
          add(Finding::Kind::note, name,
              "a file of a process that was killed while it wrote; it may be removed");
        }
      } else if (name.starts_with("journal.torn-")) {
        add(Finding::Kind::note, name, "what was cut off the journal's end; it may be removed");
      } else if (name.ends_with(".damaged")) {
        add(Finding::Kind::note, name, "what a repair set aside; it may be removed");
      }
    }
  }

  std::filesystem::path folder_;
  RunSurvey survey_;
  std::optional<ResultSurvey> result_;
  std::string recorded_optimizer_;  // in the manifest, with the seed
  json recorded_seed_;
};

}  // namespace

const char* to_string(RunSurvey::State state) {
  switch (state) {
    case RunSurvey::State::begun:
      return "unfinished";
    case RunSurvey::State::finished:
      return "finished";
    case RunSurvey::State::failed:
      return "failed";
  }
  return "?";
}

bool RunSurvey::is_damaged() const {
  return std::ranges::any_of(
      findings, [](const Finding& finding) { return finding.kind != Finding::Kind::note; });
}

bool RunSurvey::is_journal_damaged() const {
  return std::ranges::any_of(findings, [](const Finding& finding) {
    return finding.kind != Finding::Kind::note && finding.file == "journal";
  });
}

RunSurvey survey_run(const std::filesystem::path& folder, const std::filesystem::path& name) {
  return RunSurveyor(folder, name).run();
}

bool is_run_folder(const std::filesystem::path& folder) {
  return is_there(folder / "manifest.json") || is_there(folder / "journal") ||
         is_there(folder / "cell.json");
}

}  // namespace armwright
