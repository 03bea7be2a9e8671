// What a run is and how it ended, as label and value. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>

#include "report/evidence/recorded_run.hpp"

namespace armwright {

// A list of Fact.
nlohmann::json make_run_facts(const RecordedRun& run);

// RequirementLight of web/src/data.ts, one each: whether the winner meets what is required on the
// test set. Empty without a winner.
nlohmann::json make_requirements(const RecordedRun& run);

}  // namespace armwright
