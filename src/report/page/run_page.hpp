// The page of a run: one JSON text with all that its figures, tables and replay show, RunData of
// web/src/data.ts.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/stop_signal.hpp"
#include "report/evidence/page_options.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// Of a run that has ended or one under way, whose folder is only read. The same folder gives the
// same bytes for any number of threads. Where the problem cannot be made again as it was, parts
// that need it are left out and the page's notes say so. Nothing if stopped. Error{usage} if the
// folder is no run's or one of the cases asked for is none; Error{bad_data} for damaged files.
std::optional<std::string> make_run_page(const std::filesystem::path& folder,
                                         const PageOptions& options, StopSignal& stop,
                                         RunObserver& observer);

}  // namespace armwright
