// Simulates the motions of a reproduction's page. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/evidence/page_simulator.hpp"
#include "report/page/page_data.hpp"
#include "report/reproduction/reproduction.hpp"

namespace armwright {

// Returns an object with the lists robots (Robot), replays (ReplaySet) and momentary
// (ReproductionData.momentary) of web/src/data.ts: the replays of the configuration whose published
// result is in the record. `notes` gets a whole sentence on everything that is not shown. Throws
// WorkStopped; Error{usage} if a case of the options does not exist.
nlohmann::json make_reproduction_replays(const ReproductionRecord& record,
                                         const ReproductionConfig& config,
                                         const PageOptions& options, PageSimulator& simulator,
                                         std::vector<std::string>& notes);

}  // namespace armwright
