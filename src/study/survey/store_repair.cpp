#include "study/survey/store_repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "study/journal/journal_file.hpp"
#include "study/run/run_lock.hpp"
#include "study/survey/folder_copy.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAside = ".damaged";

// Returns NAME.damaged, or NAME.damaged-2, ... if that exists already.
fs::path choose_aside(const fs::path& folder, const fs::path& name) {
  const auto is_taken = [&](const fs::path& one) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(folder / one, ignored));
  };
  fs::path aside = name.string() + kAside;
  for (int number = 2; is_taken(aside); ++number) {
    aside = fmt::format("{}-{}{}", name.string(), number, kAside);
  }
  return aside;
}

// Returns whether it is a lock or a partial file of a killed process. Copies do not need these.
bool is_left_behind(const fs::path& name) {
  const std::string text = name.filename().string();
  return text == "lock" || text.ends_with(".new");
}

// Returns whether it is a folder, and no link to one.
bool is_folder_itself(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(fs::symlink_status(path, ignored));
}

class Repair {
 public:
  Repair(const StoreSurvey& survey, FolderCopy& copy) : survey_(survey), copy_(copy) {
    for (const RunSurvey& run : survey.runs) {
      if (run.is_damaged()) {
        damaged_runs_[run.name.lexically_normal()] = &run;
      }
    }
    report_.copy = copy.target();
  }

  StoreRepair run() {
    copy_folder(".", ".");
    return std::move(report_);
  }

 private:
  void copy_folder(const fs::path& name, const fs::path& to) {
    const auto found = damaged_runs_.find(name.lexically_normal());
    const RunSurvey* run = found != damaged_runs_.end() ? found->second : nullptr;
    // The lock keeps processes from writing the run while it is read. A worker process can outlive
    // its killed comparison.
    const RunLock lock = RunLock::for_reading(survey_.folder / name);
    if (run != nullptr && run->is_manifest_lost) {
      copy_as_it_is(name, choose_aside(survey_.folder, name));
      report_.runs.push_back(
          {.name = run->name, .is_set_aside = true, .evaluations_lost = count_recorded(*run)});
      return;
    }
    if (name != ".") {
      copy_.make_folder(to);
    }
    RunRepair done;
    for (const fs::path& path : list_folder(survey_.folder / name)) {
      const fs::path entry = path.filename();
      const fs::path from = (name / entry).lexically_normal();
      if (is_left_behind(entry) || (entry == kChecksumFile && has_new_checksums(name, run))) {
        continue;
      }
      if (is_folder_itself(path)) {
        copy_folder(from, from);
      } else if (run != nullptr) {
        copy_of_run(*run, from, entry.string(), done);
      } else if (std::ranges::count(survey_.damaged_files, from) > 0) {
        add(from, choose_aside(survey_.folder, from));
        report_.kept_aside.push_back(from);
      } else {
        add(from, from);
      }
    }
    if (has_new_checksums(name, run)) {
      add_checksums(name, run);
    }
    if (run != nullptr) {
      done.name = run->name;
      done.evaluations_kept = run->journal ? run->journal->evaluations.size() : 0;
      if (run->journal) {
        done.evaluations_kept -= run->journal->contradictory.size();
      }
      done.evaluations_lost = run->lost;
      report_.runs.push_back(std::move(done));
    }
  }

  // Returns whether the folder has checksums and loses files in the copy: a damaged run, or a
  // damaged study or reproduction.
  bool has_new_checksums(const fs::path& name, const RunSurvey* run) const {
    if (run != nullptr) {
      return run->has_checksums || is_there(survey_.folder / name / kChecksumFile);
    }
    const bool has_new_run = std::ranges::any_of(survey_.runs, &RunSurvey::has_checksums);
    return name == "." && survey_.kind != StoreSurvey::Kind::run &&
           (has_new_run || is_there(survey_.folder / kChecksumFile));
  }

  // Writes the checksums of what the copy keeps. A damaged run keeps its manifest. If the checksums
  // themselves are damaged, only the record is covered; the command that resumes covers the rest.
  void add_checksums(const fs::path& name, const RunSurvey* run) {
    const fs::path folder = survey_.folder / name;
    const bool is_study = survey_.kind == StoreSurvey::Kind::study;
    const std::string record = run != nullptr ? "manifest.json"
                               : is_study     ? "study.toml"
                                              : "reproduction.json";
    std::map<std::string, std::string> lines;
    const auto& damaged = survey_.damaged_files;
    if (run == nullptr && std::ranges::count(damaged, fs::path(kChecksumFile)) == 0) {
      lines = FolderChecksums(folder).lines();
      std::erase_if(lines, [&](const auto& line) {
        return std::ranges::count(damaged, fs::path(line.first)) > 0 ||
               damaged_runs_.contains(fs::path(line.first).parent_path());
      });
    }
    constexpr std::size_t kRecordLimit_bytes = std::size_t{256} << 20;
    lines[record] = calc_sha256_hex(read_file(folder / record, kRecordLimit_bytes));
    const std::string text = format_checksums(lines);
    copy_.add_file((name / kChecksumFile).lexically_normal(), [&](int fd) {
      if (const int error = write_fully(fd, text).error; error != 0) {
        fail_io(copy_.target(), "write a file of the copy", error);
      }
    });
  }

  static std::uint64_t count_recorded(const RunSurvey& run) {
    return (run.journal ? run.journal->evaluations.size() : 0) + run.lost;
  }

  void copy_of_run(const RunSurvey& run, const fs::path& from, const std::string& name,
                   RunRepair& done) {
    const bool is_derived = is_derived_file(name);
    const bool is_damaged = std::ranges::count(run.damaged_files, name) > 0;
    const bool is_journal = name == "journal" && run.is_journal_damaged();
    if (is_damaged || is_journal) {
      add(from, choose_aside(survey_.folder, from));
      done.kept_aside.push_back(name);
    }
    if (is_journal && !run.is_journal_unreadable) {
      copy_.add_file(from, [&](int fd) {
        done.journal = repair_journal(survey_.folder / from, *run.journal, fd);
      });
      done.has_new_journal = true;
    } else if (is_derived) {
      done.made_again.push_back(name);
    } else if (!is_journal) {
      add(from, from);
    }
  }

  void copy_as_it_is(const fs::path& name, const fs::path& to) {
    copy_.make_folder(to);
    for (const fs::path& path : list_folder(survey_.folder / name)) {
      const fs::path inside = path.filename();
      if (is_left_behind(inside)) {
        continue;
      }
      if (is_folder_itself(path)) {
        copy_as_it_is(name / inside, to / inside);
      } else {
        add(name / inside, to / inside);
      }
    }
  }

  void add(const fs::path& from, const fs::path& to) {
    if (!copy_.add(survey_.folder / from, to)) {
      report_.left_out.push_back(from);
    }
  }

  const StoreSurvey& survey_;
  FolderCopy& copy_;
  std::map<fs::path, const RunSurvey*> damaged_runs_;
  StoreRepair report_;
};

// Throws if the copy would lie inside its original, which would then copy the copy.
void check_target(const fs::path& folder, const fs::path& target) {
  const auto inside = fs::weakly_canonical(fs::absolute(target))
                          .lexically_relative(fs::weakly_canonical(fs::absolute(folder)));
  if (!inside.empty() && *inside.begin() != "..") {
    throw Error(ErrorKind::usage,
                fmt::format("--out is '{}', which lies in the folder itself; name one outside",
                            sanitize(target.string())));
  }
}

[[noreturn]] void refuse_lost(const StoreSurvey& survey) {
  throw Error(ErrorKind::bad_data, fmt::format("{}: {}", sanitize(survey.folder.string()),
                                               advise_on_lost_record(survey, "armwright")));
}

}  // namespace

std::optional<StoreRepair> repair_store(const fs::path& folder, const fs::path& target,
                                        StopSignal& stop) {
  // Held from before the survey until the copy is complete.
  std::optional<RunLock> lock;
  if (folder_exists(folder)) {
    lock.emplace(RunLock::for_reading(folder));
    check_target(folder, target);
  }
  const StoreSurvey survey = survey_store(folder);
  for (const RunSurvey& run : survey.runs) {
    if (!run.writer.empty()) {
      throw Error(ErrorKind::busy, fmt::format("{} is being written by {}; wait for it, or stop it",
                                               sanitize((folder / run.name).string()), run.writer));
    }
  }
  if (!survey.is_damaged()) {
    return std::nullopt;
  }
  if (survey.is_record_lost) {
    refuse_lost(survey);
  }
  FolderCopy copy(target, stop);
  StoreRepair report = Repair(survey, copy).run();
  copy.put_in_place();
  return report;
}

}  // namespace armwright
