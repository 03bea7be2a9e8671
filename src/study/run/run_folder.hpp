// The folder of a run. It holds manifest.json (the configuration and the build), journal (every
// evaluation), lock, optimizer.log (the output of plugins), and the files derived from the journal:
// result.json, winner.toml, convergence.csv, results.sqlite, winner-trajectory.csv. SHA256SUMS has
// the checksums of these files (base/folder_checksums.hpp). No run overwrites the folder of another
// one, and two processes never write the same folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/folder.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_lock.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

// The version of manifest.json. Readers must check it.
inline constexpr int kManifestFormat = 1;

// The largest files that are read; larger ones are refused as damaged.
inline constexpr std::size_t kManifestLimit_bytes = std::size_t{16} << 20;
inline constexpr std::size_t kResultLimit_bytes = std::size_t{256} << 20;
inline constexpr std::size_t kCellLimit_bytes = std::size_t{64} << 20;

class RunFolder {
 public:
  // Creates the folder, or opens it to resume its run. Follows no link below `root` (Folder::make).
  // Takes the lock, then writes the manifest or compares it with `plan`. If the folder holds a run
  // and its rights do not allow the lock for writing, takes the lock for reading. Throws
  // Error{busy} if another process has the lock, Error{io}, Error{bad_data} if the manifest is
  // damaged or a link is in the way, and Error{usage} if the folder holds other files or a run with
  // another configuration; the message lists every difference. A larger budget alone is no other
  // configuration if it continues the run (explain_no_continuation()).
  RunFolder(const std::filesystem::path& path, const std::filesystem::path& root,
            const RunPlan& plan, std::span<const std::string> command_line);

  const Folder& folder() const { return folder_; }
  const std::filesystem::path& path() const { return folder_.path(); }
  std::filesystem::path journal() const { return path() / "journal"; }
  std::filesystem::path log() const { return path() / "optimizer.log"; }
  // Throws Error{io} if this process may only read the folder.
  void check_writable() const;
  // Returns whether the run has begun with checksums, as all runs since version 2.0 have.
  bool has_checksums() const { return has_checksums_; }
  // Returns the recorded budget if the plan has a larger one and continues the run; otherwise 0.
  std::int64_t continued_budget() const { return continued_budget_; }
  // Records that the run goes on with the budget of the plan. Removes the files that are derived from
  // its journal, appends a ContinueRecord, and replaces the manifest last. A kill before that leaves
  // the run of the smaller budget, whose command makes its files again from the journal. A kill after
  // that leaves an interrupted run of the larger budget. `evaluations` is the number of recorded
  // training evaluations. To be called once, if continued_budget() is above 0. Throws Error{io}.
  void record_larger_budget(Journal& journal, std::uint64_t evaluations) const;
  // Returns the differences between the recorded build and this one (version, compiler, CPU), which
  // may keep a resumed run from replaying. Empty if there are none.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  Folder folder_;
  std::string obstacle_;  // to writing; empty if there is none
  RunLock lock_;
  bool has_checksums_ = true;
  std::int64_t continued_budget_ = 0;
  std::int64_t budget_ = 0;  // of the plan
  std::string manifest_;     // that records the larger budget
  std::vector<std::string> warnings_;
};

// Returns the names of the files that a run derives from its journal, and a comparison from its
// cell.
const std::vector<std::string>& derived_file_names();

// Where a run keeps the files that its winner's test case left (winner_record.hpp). Their names
// depend on the problem.
inline constexpr const char* kWinnerFiles = "winner-files/";
// What an identification leaves beside these: the robot's plant, and what is known of the fit.
inline constexpr const char* kPlantFile = "plant.toml";
inline constexpr const char* kIdentificationFile = "identification.json";
// How the winner of an arm does under other conditions (study/verification/winner_check.hpp).
inline constexpr const char* kCheckFile = "check.json";
inline constexpr std::size_t kIdentificationLimit_bytes = std::size_t{256} << 20;
// Returns whether a file, named relative to the run's folder, is derived from the journal.
bool is_derived_file(const std::string& name);

// Returns whether version 1.0 began the run with this manifest.
bool is_of_version_1(const nlohmann::json& manifest);
inline constexpr const char* kIsOfVersion1 =
    "version 1.0 of armwright began this run, and this version reads none of its runs; use version "
    "1.0 for it, or begin a new run in another folder (--out or --new)";

// Covers all files of a run that are complete: the manifest, the derived files and, if the run has
// ended, the journal. Throws Error{io}.
void cover_run(const Folder& folder, bool has_ended);

// Gives the plan of an optimizer with a pace_option the number of evaluations with which the run in
// the folder began, if that run has a smaller budget or has been continued. Does nothing if the user
// has set the option. Throws Error{bad_data} if the manifest is damaged, and Error{io}.
void keep_pace(const std::filesystem::path& folder, RunPlan& plan);

// Returns the problem that the run in the folder has recorded. Starts no program. Throws as
// load_recorded_plan().
LoadedProblem load_problem_of_run(const std::filesystem::path& folder);

// Returns the plan that the run in the folder has recorded, for a run without racing. Starts no
// program of a problem. Refuses a plugin and an option that writes to a file by Error{usage}: somebody
// else may have made the folder. Throws Error{usage} if the folder is not a run's, Error{bad_data}
// if the manifest is damaged, and what loading the problem and the optimizer throws.
RunPlan load_recorded_plan(const std::filesystem::path& folder);

// Returns parent/NAME or, with `fresh`, the first of NAME, NAME-002, NAME-003, ... that does not
// exist.
std::filesystem::path choose_run_folder(const std::filesystem::path& parent,
                                        const std::string& name, bool fresh);

}  // namespace armwright
