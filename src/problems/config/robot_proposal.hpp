// What a problem's file leaves out about a robot of which it says `robot.propose = true`:
// orientation, home, workspace and speed, as sim/workspace_proposal.hpp and
// sim/drive_proposal.hpp propose them. What stands in the
// file holds.
#pragma once

#include <string>
#include <vector>

#include "base/config.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {

// Completes config.task and config.workspace. What it settled as KEY=VALUE texts, so that a
// recorded configuration has the numbers and need not look for them again. Error{usage} where the
// file gives half of what belongs together.
std::vector<std::string> apply_proposal(const ConfigTable& table, TrackingConfig& config);

// The proposed controllers and effort limits, for variables.start = "proposed".
ArmDesign propose_start(const TrackingConfig& config);

}  // namespace armwright
