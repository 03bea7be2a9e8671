// The motions that a reproduction's page shows. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/evidence/page_options.hpp"
#include "report/evidence/page_simulator.hpp"
#include "report/reproduction/reproduction_config.hpp"
#include "report/reproduction/reproduction_record.hpp"

namespace armwright {

struct ReproductionReplays {
  nlohmann::json robots = nlohmann::json::array();     // Robot[]
  nlohmann::json replays = nlohmann::json::array();    // ReplaySet[]
  nlohmann::json momentary = nlohmann::json::array();  // ReproductionData.momentary
};

// Those of the config whose published result is in the record. `notes` gets whole sentences about
// what is not shown. Throws PageStopped.
ReproductionReplays make_reproduction_replays(const ReproductionRecord& record,
                                              const ReproductionConfig& config,
                                              const PageOptions& options, PageSimulator& simulator,
                                              std::vector<std::string>& notes);

}  // namespace armwright
