// One cell of a study, run by one of perhaps several processes that are at it, on machines that
// know nothing of each other: an attempt (attempt.hpp) that goes on from the furthest earlier one
// and is published (publication.hpp) if it is still the newest when it is done.
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
  unsigned jobs = 1;
  std::vector<std::string> command_line;  // for the manifest
  std::int64_t process_begun_s = 0;       // Unix time
};

struct CellAttempt {
  enum class End {
    done,        // the cell is in its place, by us or by another
    stopped,     // by `stop`; a later attempt goes on
    superseded,  // a newer attempt is at it
  };
  End end = End::done;
  std::string successor;          // of one that was superseded: "superseded by attempt 3"
  bool optimizer_failed = false;  // of a cell that is done by us
};

// Within a second of a newer attempt's begin `stop` is requested (StopReason::terminated): whoever
// runs several cells in a row is an orphan then. An Error is recorded in the attempt and thrown.
CellAttempt attempt_cell(const StudyPlan& plan, const Cell& cell, const CellAttemptRequest& request,
                         StopSignal& stop, RunObserver& observer);

}  // namespace armwright
