// A study's folder:
//
//   study.toml                    the resolved plan with its hash, written before any cell runs
//   problems/LABEL.json           the whole configuration of each problem
//   cells/PROBLEM/OPTIMIZER/rNN   the runs
//   result.json, verdict.txt, tables/, final/   derived from the files above
//   SHA256SUMS                    the checksums of all these files; of a run, that of its SHA256SUMS
//
// A plan may grow by replicates, problems and optimizers. Recorded problems and optimizers must not
// be changed or left out, so that all cells stay comparable. Title, targets, reference and value
// may change and be removed, because no run depends on them. The plans before each extension are kept as
// study-001.toml, study-002.toml, ...
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "study/compare/study_plan.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {

// A study's folder that this process has locked for writing.
class StudyFolder {
 public:
  // Creates the folder, or opens it to resume the study, and takes its lock. Throws Error{busy} if
  // another process has the lock, Error{bad_data} if the recorded plan is damaged, or Error{io}.
  // Throws Error{usage} with every difference that would make recorded cells incomparable.
  StudyFolder(const std::filesystem::path& path, const StudyPlan& plan);

  const std::filesystem::path& path() const { return folder_.path(); }
  // Returns one text per part of the plan that the recorded plan did not have; empty if it has all.
  const std::vector<std::string>& additions() const { return additions_; }

 private:
  void extend(const StudyPlan& plan, const std::string& text, FolderChecksums& checksums);

  Folder folder_;
  RunLock lock_;
  std::vector<std::string> additions_;
};

// Returns the resolved plan as TOML, which make_study_plan() can read again. Its first key is the
// SHA-256 of the text after it.
std::string to_toml(const StudyPlan& plan);
std::string calc_plan_hash(const StudyPlan& plan);

// Covers all files of the study with checksums. To be called when its tables are written. Throws
// Error{io}.
void cover_study(const StudyPlan& plan, const std::filesystem::path& study);
// Returns the names of the files, relative to the study, that its checksums cover, apart from its
// cells. Throws Error{io} or std::filesystem::filesystem_error if the folder cannot be read.
std::vector<std::string> list_study_files(const std::filesystem::path& study);
// Removes from the study's checksums those cells of the plan that have not ended, because they are
// going to change. The caller holds the study's lock.
void uncover_unfinished(const StudyPlan& plan, std::span<const Cell> cells,
                        const std::filesystem::path& study);

// Returns whether the folder is a study's.
bool is_study_folder(const std::filesystem::path& path);
// Throws Error{usage} if the folder does not exist or is not a study's.
void check_study_folder(const std::filesystem::path& folder);
// Adds to `plan` the baselines that the folder's recorded plan has, and keeps its labels, its SIMD
// levels (keep_simd_levels()) and the random streams of the optimizers (adopt_streams()).
// Does nothing if the folder is not a study's. To be called before the constructor of StudyFolder.
void adopt_recorded(const std::filesystem::path& folder, StudyPlan& plan);
// Returns the plan that a study's folder records, to be read. Starts no plugin and opens none, so
// the plugins need not exist; their cells cannot run. Throws Error{usage} or Error{bad_data}.
StudyPlan load_study_plan(const std::filesystem::path& folder);
// The same for a plan whose cells shall run. The plugins need consent
// (study/compare/plugin_consent.hpp).
StudyPlan load_study_plan(const std::filesystem::path& folder, const AskUser& ask);

}  // namespace armwright
