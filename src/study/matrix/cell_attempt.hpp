// Runs one cell of a study by an attempt (attempt.hpp). Several processes may run the same cell on
// machines that cannot talk to each other. An attempt resumes from the earlier attempt with the
// most evaluations. It is published if it is still the newest when it ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/compare/study_plan.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

struct CellAttemptRequest {
  std::filesystem::path study;
  unsigned jobs = 1;                      // threads
  std::vector<std::string> command_line;  // for the manifest
  std::int64_t process_begun_s = 0;       // Unix time
};

struct CellAttempt {
  enum class End {
    done,        // the cell is in its place, published by this attempt or another one
    stopped,     // `stop` ended it; a later attempt resumes it
    superseded,  // a newer attempt runs the cell
  };
  End end = End::done;
  std::string successor;          // only if superseded: "superseded by attempt 3"
  bool optimizer_failed = false;  // only if done by this attempt
};

// Runs the cell by a new attempt. Requests `stop` (StopReason::terminated) within a second after a
// newer attempt begins: this process was then left behind and must not run its other cells either.
// An Error is recorded in the attempt and thrown.
CellAttempt attempt_cell(const StudyPlan& plan, const Cell& cell, const CellAttemptRequest& request,
                         StopSignal& stop, RunObserver& observer);

// Makes `run` the folder of a run that begins with the longest recorded state of the cell: manifest
// and journal. The state comes from an attempt, which may still be running, or from the unfinished
// cell in its place. States that cannot be read are skipped with a message; their evaluations are
// repeated. Creates nothing if there is no state. Throws Error{io}.
void copy_furthest_state(const StudyPlan& plan, const Cell& cell,
                         const std::filesystem::path& study, const std::filesystem::path& run,
                         RunObserver& observer);

// Puts the longest state of each unfinished cell that attempts have begun in the cell's place. The
// caller is a local comparison that holds the study's lock. Attempts that are still running are
// superseded. Throws Error{io}.
void adopt_attempts(const StudyPlan& plan, const std::filesystem::path& study,
                    RunObserver& observer);

}  // namespace armwright
