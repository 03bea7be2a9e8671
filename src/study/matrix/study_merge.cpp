#include "study/matrix/study_merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/study_folder.hpp"
#include "study/matrix/attempt.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/run/run_folder.hpp"
#include "study/survey/folder_copy.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Compares settings: cell.json has problem, optimizer and configuration; the manifest has all other
// settings of the run.
std::string find_other_settings(const StudyPlan& plan, const Cell& cell,
                                const std::filesystem::path& folder) {
  const auto file = folder / "manifest.json";
  try {
    const json manifest = json::parse(read_checked_json(file, kManifestLimit_bytes));
    const auto differences = describe_differences(manifest.at("configuration").dump(),
                                                  to_json(make_run_plan(plan, cell)));
    return differences.empty() ? "" : differences.front();
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not a manifest that armwright wrote ({})",
                                                 file.string(), describe_json_error(error.what())));
  }
}

struct FoundCell {
  Cell cell;
  std::filesystem::path folder;
};

class CellImport {
 public:
  CellImport(const StudyPlan& plan, const std::filesystem::path& study,
             std::span<const std::filesystem::path> others)
      : plan_(plan), study_(study), others_(others) {
    std::ranges::for_each(others, check_study_folder);
    for (const Cell& cell : list_cells(plan)) {
      find(cell);
    }
    if (!refusals_.empty()) {
      constexpr std::size_t kMostListed = 20;
      const std::size_t count = refusals_.size();
      if (count > kMostListed) {
        refusals_.resize(kMostListed);
        refusals_.push_back(fmt::format("and {} more", count - kMostListed));
      }
      throw Error(ErrorKind::bad_data,
                  fmt::format("nothing is merged: the folders hold cells that contradict each "
                              "other:\n  {}\nKeep one of each two, or leave the folder out",
                              join(refusals_, "\n  ")));
    }
  }

  std::span<const FoundCell> found() const { return found_; }

 private:
  void find(const Cell& cell) {
    const auto path = make_cell_path(plan_, cell);
    std::string text;
    std::filesystem::path first;
    if (load_cell(plan_, cell, study_)) {
      first = study_ / path;
      text = read_checked_file(first / "cell.json", kCellLimit_bytes);
    }
    for (const auto& other : others_) {
      const auto folder = other / path;
      if (!load_cell(plan_, cell, other)) {
        continue;
      }
      const std::string one = read_checked_file(folder / "cell.json", kCellLimit_bytes);
      const std::string difference = find_other_settings(plan_, cell, folder);
      if (!difference.empty()) {
        refuse(cell,
               fmt::format("{} was run with other settings: {}", folder.string(), difference));
      } else if (first.empty()) {
        first = folder;
        text = one;
        found_.push_back({cell, folder});
      } else if (one != text) {
        refuse(cell,
               fmt::format("{} and {} have different results", first.string(), folder.string()));
      }
    }
  }

  void refuse(const Cell& cell, const std::string& why) {
    refusals_.push_back(sanitize(make_cell_name(plan_, cell) + ": " + why));
  }

  const StudyPlan& plan_;
  const std::filesystem::path& study_;
  std::span<const std::filesystem::path> others_;
  std::vector<FoundCell> found_;
  std::vector<std::string> refusals_;
};

// Throws Error{bad_data} for a link, which FolderCopy would copy. What it leads to is no part of the
// cell.
void check_not_link(const std::filesystem::path& file) {
  std::error_code ignored;  // FolderCopy reports it
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(file, ignored))) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is a symbolic link, and a cell holds only files; put the file in "
                            "its place, or remove the link",
                            file.string()));
  }
}

// Copies the cell by an attempt of its own, which also supersedes other attempts at the cell.
void copy_cell(const StudyPlan& plan, const FoundCell& found, const std::filesystem::path& study,
               StopSignal& stop) {
  const Attempt attempt(make_attempts_path(plan, found.cell, study), study, std::time(nullptr));
  FolderCopy copy(attempt.run(), stop);
  for (const auto& entry : list_folder(found.folder)) {
    const auto name = entry.filename();
    if (name != "lock" && name.extension() != ".new") {
      check_not_link(entry);
      copy.add(entry, name);
    }
  }
  copy.put_in_place();
  publish_cell(plan, found.cell, study, attempt.run(), attempt.aside());
  attempt.end_in_order();
}

}  // namespace

std::size_t import_cells(const StudyPlan& plan, const std::filesystem::path& study,
                         std::span<const std::filesystem::path> others, StopSignal& stop) {
  const CellImport cells(plan, study, others);
  std::size_t copied = 0;
  for (const FoundCell& found : cells.found()) {
    try {
      copy_cell(plan, found, study, stop);
    } catch (const WorkStopped&) {
      break;
    }
    ++copied;
  }
  return copied;
}

void remove_spent_attempts(const StudyPlan& plan, const std::filesystem::path& study) {
  if (!path_exists(study / kAttemptsFolder)) {
    return;
  }
  // A superseded process may still write there; the next call removes its files.
  std::error_code ignored;
  for (const Cell& cell : list_cells(plan)) {
    const auto attempts = make_attempts_path(plan, cell, study);
    if (std::filesystem::exists(attempts, ignored) && load_cell(plan, cell, study)) {
      Folder::make(attempts, study);  // throws if a link is on the way, which could lead anywhere
      std::filesystem::remove_all(attempts, ignored);
      // remove() removes these folders only if they are empty.
      std::filesystem::remove(attempts.parent_path(), ignored);
      std::filesystem::remove(attempts.parent_path().parent_path(), ignored);
    }
  }
  std::filesystem::remove(study / kAttemptsFolder, ignored);
}

}  // namespace armwright
