// What a run is and how it ended, as label and value. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>

#include "report/page/recorded_run.hpp"

namespace armwright {

// A list of Fact.
nlohmann::json make_run_facts(const RecordedRun& run);

}  // namespace armwright
