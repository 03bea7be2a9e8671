// A study's folder: study.toml (the resolved plan with its hash, written before anything runs),
// problems/LABEL.json (each problem's whole configuration), cells/PROBLEM/OPTIMIZER/rNN (the runs),
// and what is derived from these: result.json, verdict.txt, tables/.
//
// A plan may grow: more replicates, problems, optimizers. What is there must stay comparable, and
// stay: nothing recorded may be changed or left out, but for what is asked of the cells afterwards
// (targets, reference, value). The plan before an extension is kept as
// study-001.toml, study-002.toml, ...
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {

class StudyFolder {
 public:
  // Creates the folder, or opens it to go on; takes the lock. Error{busy}; Error{io}; Error{usage}
  // with every difference that would make recorded cells incomparable.
  StudyFolder(const std::filesystem::path& path, const StudyPlan& plan);

  const std::filesystem::path& path() const { return path_; }
  // What the plan has that the recorded one had not; empty if nothing.
  const std::vector<std::string>& additions() const { return additions_; }

 private:
  void extend(const StudyPlan& plan, const std::string& text);

  std::filesystem::path path_;
  RunLock lock_;
  std::vector<std::string> additions_;
};

// The resolved plan as TOML, which make_study_plan() reads again. Its first key is the SHA-256 of
// the text after it.
std::string to_toml(const StudyPlan& plan);
std::string calc_plan_hash(const StudyPlan& plan);

// Whether a folder is a study's.
bool is_study_folder(const std::filesystem::path& path);
// Error{usage} if it is none, or not there.
void check_study_folder(const std::filesystem::path& folder);
// The plan with what a folder's plan has beside it by itself: baselines. Before StudyFolder.
void adopt_recorded(const std::filesystem::path& folder, StudyPlan& plan);
// The plan that a study's folder records.
StudyPlan load_study_plan(const std::filesystem::path& folder);

}  // namespace armwright
