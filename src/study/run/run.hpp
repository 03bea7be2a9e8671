// One run from plan to result: optimize, judge the candidates on the validation set, judge the
// winner on the test set, derive the tables. Resumable at any moment: start it again with the same
// plan and folder.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "base/stop_signal.hpp"
#include "study/executor/case_executor.hpp"
#include "study/run/run_observer.hpp"
#include "study/run/run_plan.hpp"
#include "study/run/run_result.hpp"
#include "study/run/store.hpp"

namespace armwright {

struct RunRequest {
  RunPlan plan;
  std::filesystem::path folder;
  unsigned jobs = 1;                      // threads
  std::vector<std::string> command_line;  // for the manifest
  DerivedFiles derived = DerivedFiles::all;
  CaseExecutor* executor = nullptr;  // instead of `jobs` threads of its own
};

// The result, or nothing if `stop` ended the run early; everything evaluated so far is in the
// journal then. A run that has ended already is not run again: its recorded result is returned.
std::optional<RunResult> execute_run(const RunRequest& request, StopSignal& stop,
                                     RunObserver& observer);

// A design on the cases first, ..., first + cases - 1 of a set, fanned out over `jobs` threads,
// with what the problem requires of each. Nothing if stopped.
std::optional<std::vector<MeasuredCase>> evaluate_design(const TrackingProblem& problem,
                                                         const ArmDesign& design,
                                                         const TestSet& set, std::uint64_t first,
                                                         std::uint64_t cases, unsigned jobs,
                                                         StopSignal& stop);

// The result recorded in a folder. Error{usage} if the folder is no run or its run has not ended,
// saying how to go on.
RunResult load_result(const std::filesystem::path& folder);

}  // namespace armwright
