// Copies what an earlier attempt at a cell has left, so that a new attempt continues from it.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <functional>
#include <string>
#include <string_view>
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
#include "study/run/run_times.hpp"

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

// Copies the file into the folder. Returns false if another process has published or removed it in
// the meantime.
bool copy_file_into(const Folder& folder, const std::filesystem::path& source) {
  std::error_code ignored;
  if (!std::filesystem::exists(source, ignored)) {
    return false;
  }
  const FileDescriptor from = open_to_read(source);
  AtomicFile to(folder, source.filename().string());
  std::string chunk(1 << 20, '\0');
  while (true) {
    const ssize_t got = ::read(from.get(), chunk.data(), chunk.size());
    if (got < 0 && errno != EINTR) {
      fail_io(source, "read it", errno);
    }
    if (got == 0) {
      to.commit();
      return true;
    }
    to.write(std::string_view(chunk).substr(0, got > 0 ? static_cast<std::size_t>(got) : 0));
  }
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
    const Folder folder = Folder::make(run, study);
    try {
      // Another process may still write the journal, so the last record of the copy may be torn.
      if (!copy_file_into(folder, earlier.folder / "journal")) {
        continue;
      }
      read_journal(run / "journal");
      const std::string name = "manifest.json";
      const std::string manifest = read_checked_file(earlier.folder / name, kManifestLimit_bytes);
      FolderChecksums checksums(folder);
      checksums.cover(name, manifest);
      checksums.save();
      write_file_atomically(folder, name, manifest);
      copy_file_into(folder, earlier.folder / kTimesFile);
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
  if (!path_exists(study / kAttemptsFolder)) {
    return;
  }
  for (const Cell& cell : list_cells(plan)) {
    const auto attempts = make_attempts_path(plan, cell, study);
    if (list_tokens(attempts).empty() || load_cell(plan, cell, study)) {
      continue;
    }
    const Attempt attempt(attempts, study, std::time(nullptr));
    copy_furthest_state(plan, cell, study, attempt.run(), observer);
    const auto target = study / make_cell_path(plan, cell);
    if (path_exists(attempt.run())) {
      move_folder_if_there(target, attempt.aside());
      Folder::make(target.parent_path(), study);
      move_folder_if_there(attempt.run(), target);
    }
    attempt.end_in_order();
  }
}

}  // namespace armwright
