// The folder of a reproduction: reproduction.json (every part that has been computed, with what it
// was computed from), runs/NAME (ordinary runs) and lock. An interrupted reproduction goes on with
// what is there; what is recorded is never made again, and nothing of other settings is mixed in.
// reproduction.json holds the same bytes however often it was interrupted.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "report/evidence/point_statistics.hpp"
#include "report/reproduction/reproduction_plan.hpp"
#include "study/run/design_evaluation.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {

struct PartResult {
  ReproductionPart part;
  std::string inputs_sha256;  // of all that determines it
  std::string engine;
  std::string test_set;
  std::vector<double> case_errors;    // one a case; NaN where there is none
  std::vector<CaseFailure> failures;  // the cases without number
  PointStatistics points;
  double total_torque_n_m = 0;

  ErrorSummary calc_summary() const;
  // Ours over what is published, where both exist.
  std::optional<double> calc_ratio() const;
};

struct ReproductionRecord {
  std::string config;
  std::optional<std::uint64_t> cases;
  std::vector<std::string> overrides;
  std::map<std::string, std::string> build;   // of the program that began it
  std::vector<std::string> planned;           // labels of all parts, sorted
  std::map<std::string, PartResult> results;  // by label
};

// Whether a folder is a reproduction's.
bool is_reproduction_folder(const std::filesystem::path& path);
// Error{usage} if the folder is none; Error{bad_data} if its record is damaged.
ReproductionRecord load_reproduction(const std::filesystem::path& folder);

// The SHA-256 of all that determines a part's result but the program.
std::string calc_inputs_hash(const ReproductionPlan& plan, const PlannedPart& part);

class ReproductionFolder {
 public:
  // Creates the folder or opens it to go on; takes the lock. What the plan has beside what is
  // recorded is added to it. Error{busy}; Error{io}; Error{bad_data} for a damaged record;
  // Error{usage} if the folder holds something else, or a reproduction of other settings.
  ReproductionFolder(const std::filesystem::path& path, const ReproductionPlan& plan);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path get_run_folder(const std::string& run) const {
    return path_ / "runs" / run;
  }
  // What has changed about the program since the reproduction was begun; empty if nothing.
  const std::vector<std::string>& warnings() const { return warnings_; }
  const PartResult* find(const std::string& label) const;
  void add(PartResult result);

 private:
  void check(const ReproductionPlan& plan) const;
  void write() const;

  std::filesystem::path path_;
  RunLock lock_;
  ReproductionRecord record_;
  std::vector<std::string> warnings_;
};

}  // namespace armwright
