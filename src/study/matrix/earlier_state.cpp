// Copies what an earlier attempt at a cell has left, so that a new attempt continues from it.

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <system_error>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "study/compare/cell.hpp"
#include "study/journal/journal.hpp"
#include "study/matrix/attempt.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

struct EarlierRun {
  std::filesystem::path folder;
  std::uintmax_t journal_bytes = 0;
};

// Returns the earlier runs, the longest journal first. Runs of one cell record the same
// evaluations, so the longest journal has the most of them.
std::vector<EarlierRun> find_earlier_runs(const StudyPlan& plan, const Cell& cell,
                                          const std::filesystem::path& study) {
  std::vector<std::filesystem::path> folders = {study / make_cell_path(plan, cell)};
  const auto attempts = make_attempts_path(plan, cell, study);
  for (const int token : list_tokens(attempts)) {
    std::error_code error;
    for (std::filesystem::directory_iterator entry(make_token_path(attempts, token), error), end;
         !error && entry != end; entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      if (name == "run" || name.starts_with("aside")) {
        folders.push_back(entry->path());
      }
    }
  }
  std::vector<EarlierRun> runs;
  for (const auto& folder : folders) {
    std::error_code missing;
    const auto bytes = std::filesystem::file_size(folder / "journal", missing);
    if (!missing && std::filesystem::is_regular_file(folder / "manifest.json", missing)) {
      runs.push_back({folder, bytes});
    }
  }
  std::ranges::stable_sort(runs, std::greater(), &EarlierRun::journal_bytes);
  return runs;
}

// Returns false if another process has published or removed the source in the meantime.
bool copy_bytes_of(const std::filesystem::path& source, const std::filesystem::path& target) {
  std::error_code error;
  std::filesystem::copy_file(source, target, std::filesystem::copy_options::overwrite_existing,
                             error);
  if (!error) {
    return true;
  }
  std::error_code ignored;
  if (!std::filesystem::exists(source, ignored)) {
    return false;
  }
  fail_io(source, "copy it to " + target.string(), error.value());
}

void move_folder_if_there(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error && error != std::errc::no_such_file_or_directory) {
    fail_io(from, "move it to " + to.string(), error.value());
  }
}

}  // namespace

void copy_furthest_state(const StudyPlan& plan, const Cell& cell,
                         const std::filesystem::path& study, const std::filesystem::path& run,
                         RunObserver& observer) {
  for (const EarlierRun& earlier : find_earlier_runs(plan, cell, study)) {
    make_folder(run);
    try {
      // Another process may still write the journal, so the last record of the copy may be torn.
      if (!copy_bytes_of(earlier.folder / "journal", run / "journal")) {
        continue;
      }
      read_journal(run / "journal");
      const std::string name = "manifest.json";
      const std::string manifest = read_checked_file(earlier.folder / name, kManifestLimit_bytes);
      FolderChecksums checksums(run);
      checksums.cover(name, manifest);
      checksums.save();
      write_file_atomically(run / name, manifest);
      return;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::bad_data) {
        throw;
      }
      observer.on_message(
          fmt::format("warning: the run in {} cannot be resumed and is made again: its "
                      "journal or manifest is damaged (armwright doctor shows where)",
                      sanitize(earlier.folder.string())));
    }
  }
  std::error_code ignored;
  std::filesystem::remove_all(run, ignored);
}

void adopt_attempts(const StudyPlan& plan, const std::filesystem::path& study,
                    RunObserver& observer) {
  if (!std::filesystem::exists(study / kAttemptsFolder)) {
    return;
  }
  for (const Cell& cell : list_cells(plan)) {
    const auto attempts = make_attempts_path(plan, cell, study);
    if (list_tokens(attempts).empty() || load_cell(plan, cell, study)) {
      continue;
    }
    const Attempt attempt(attempts, std::time(nullptr));
    copy_furthest_state(plan, cell, study, attempt.run(), observer);
    const auto target = study / make_cell_path(plan, cell);
    if (std::filesystem::exists(attempt.run())) {
      move_folder_if_there(target, attempt.aside());
      make_folder(target.parent_path());
      move_folder_if_there(attempt.run(), target);
    }
    attempt.end_in_order();
  }
}

}  // namespace armwright
