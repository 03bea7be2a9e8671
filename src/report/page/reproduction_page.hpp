// The page of a reproduction: ReproductionData of web/src/data.ts. Everything comes from the
// folder's record; only the motions of the replays are simulated.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/stop_signal.hpp"
#include "report/evidence/page_options.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// Nothing if stopped. Of an unfinished reproduction the page has what is there. Error{usage} if
// the folder holds no reproduction, or for a case that does not exist; Error{bad_data} if its
// record is damaged.
std::optional<std::string> make_reproduction_page(const std::filesystem::path& folder,
                                                  const PageOptions& options, StopSignal& stop,
                                                  RunObserver& observer);

}  // namespace armwright
