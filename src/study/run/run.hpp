// Executes one run from its plan to its result: optimizes, evaluates the candidates on the
// validation set and the winner on the test set, and writes the derived files. A run can be
// interrupted at any moment; executing it again with the same plan and folder resumes it. With a
// larger budget and otherwise the same plan, a run goes on, whether it had ended or not
// (RunFolder::record_larger_budget()).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/executor/case_executor.hpp"
#include "study/run/derived_files.hpp"
#include "study/run/run_observer.hpp"
#include "study/run/run_plan.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

struct RunRequest {
  RunPlan plan;
  std::filesystem::path folder;
  unsigned jobs = 1;                      // threads
  std::vector<std::string> command_line;  // for the manifest
  DerivedFiles derived = DerivedFiles::all;
  CaseExecutor* executor = nullptr;  // used instead of `jobs` threads of its own, if set
  std::filesystem::path root = {};   // that the user named and that holds `folder`; empty: `folder`
  // If set, nothing is simulated. The function gets the training evaluations that the optimizer asks
  // for and that the journal lacks, while this process has the run's lock, and must request the
  // stop. See ask_tell.hpp.
  std::function<void(const Folder& folder, std::span<const EvaluationRecord* const> missing)> ask =
      {};
};

// Returns the result, or nothing if `stop` ended the run early; all finished evaluations are in the
// journal then. For a run that has ended already, returns its recorded result. Throws Error{usage}
// for a plan that is not possible or differs from the recorded one, Error{busy} if another process
// writes the folder, Error{io}, and Error{bad_data} if the journal or the result is damaged or does
// not replay, or if a file or a folder below `root` is a link. A failure of the optimizer is not thrown: it is part of the result.
std::optional<RunResult> execute_run(const RunRequest& request, StopSignal& stop,
                                     RunObserver& observer);

// Returns the recorded result of a folder. Throws Error{usage} if the folder is not that of a run
// or if its run has not ended, Error{bad_data} if the result is damaged, and Error{io}.
RunResult load_result(const std::filesystem::path& folder);

}  // namespace armwright
