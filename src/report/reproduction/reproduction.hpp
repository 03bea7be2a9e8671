// Computes a reproduction and keeps its results in a folder: reproduction.json (every computed part
// and the hash of its inputs), runs/NAME (ordinary runs), SHA256SUMS (the checksums of the record
// and of the SHA256SUMS of each run) and lock. An interrupted reproduction
// continues: it computes only the parts that are missing, and it never mixes different settings.
// reproduction.json has the same bytes after any number of interruptions.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/folder.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/reproduction/reproduction_plan.hpp"
#include "study/run/design_evaluation.hpp"
#include "study/run/run.hpp"
#include "study/run/run_lock.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// A part's result.
struct PartResult {
  ReproductionPart part;
  std::string inputs_sha256;  // calc_inputs_hash()
  std::string engine;
  std::string test_set;
  std::vector<double> case_errors;    // m, one per case; NaN for a case without a number
  std::vector<CaseFailure> failures;  // the cases without a number
  PointStatistics points;
  double total_torque_n_m = 0;

  ErrorSummary calc_summary() const;
  // Returns our mean error divided by the published one; empty if one of them is missing.
  std::optional<double> calc_ratio() const;
};

// The content of reproduction.json.
struct ReproductionRecord {
  std::string config;
  std::optional<std::uint64_t> cases;
  std::vector<std::string> overrides;
  std::map<std::string, std::string> build;   // of the program that started it
  std::vector<std::string> planned;           // labels of all parts, sorted
  std::map<std::string, PartResult> results;  // by label
};

// Returns whether a folder is a reproduction's.
bool is_reproduction_folder(const std::filesystem::path& path);
// Throws Error{usage} if the folder is not a reproduction's; Error{bad_data} if its record is
// damaged.
ReproductionRecord load_reproduction(const std::filesystem::path& folder);

// Returns the SHA-256 of everything that determines a part's result, except the program.
std::string calc_inputs_hash(const ReproductionPlan& plan, const PlannedPart& part);

// The locked folder of a reproduction that is being computed.
class ReproductionFolder {
 public:
  // Creates the folder, or opens it to continue, and locks it. Adds the plan's new parts to the
  // record. Throws Error{busy} if another process has the lock; Error{io}; Error{bad_data} for a
  // damaged record; Error{usage} if the folder holds something else or a reproduction with other
  // settings.
  ReproductionFolder(const std::filesystem::path& path, const ReproductionPlan& plan);

  const std::filesystem::path& path() const { return folder_.path(); }
  std::filesystem::path get_run_folder(const std::string& run) const {
    return path() / "runs" / run;
  }
  // Returns how the program differs from the one that started the reproduction; empty if it does
  // not differ.
  const std::vector<std::string>& warnings() const { return warnings_; }
  // Returns the part's result, or null if it is not computed.
  const PartResult* find(const std::string& label) const;
  // Adds a result and writes the record. Throws Error{io}.
  void add(PartResult result);

 private:
  void check(const ReproductionPlan& plan) const;
  void write() const;

  Folder folder_;
  RunLock lock_;
  ReproductionRecord record_;
  std::vector<std::string> warnings_;
};

// Computes the parts that `folder` does not hold, on `jobs` threads. Without a folder (null) no
// result is kept. `program` is the program's name in the manifests of the runs. Returns one result
// per part in the plan's order, or nothing after a request to stop: then the folder has every
// finished part, and the same call continues. Frees each of the plan's problems after its part.
// Throws Error{usage} for a plan with runs without a folder; Error{bad_data} if a run has no
// winner.
std::optional<std::vector<PartResult>> execute_reproduction(ReproductionPlan& plan,
                                                            ReproductionFolder* folder,
                                                            const std::string& program,
                                                            unsigned jobs, StopSignal& stop,
                                                            RunObserver& observer);

// Returns the command line, beginning with `program`, that makes or continues one of the runs.
std::vector<std::string> make_run_command(const std::string& program, const RunPlan& run,
                                          const std::filesystem::path& folder);

}  // namespace armwright
