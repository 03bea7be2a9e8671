// A comparison as one JSON text for its page: StudyData of web/src/data.ts. Everything follows from
// study.toml, the cells' cell.json and the final checks; journals are not read and nothing is ever
// written or locked, so that a study can be looked at while it runs.
//
// A study under way has a page too: every optimizer's numbers are of the cells that have ended, and
// only problems that have all of theirs have ranks, tests and pairs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/stop_signal.hpp"
#include "report/evidence/page_options.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// Nothing if stopped. The same folder gives the same bytes, for any number of jobs. Error{usage} if
// the folder is not a study's; Error{bad_data} for a plan or a cell that cannot be read.
std::optional<std::string> make_study_page(const std::filesystem::path& folder,
                                           const PageOptions& options, StopSignal& stop,
                                           RunObserver& observer);

}  // namespace armwright
