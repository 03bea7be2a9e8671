// What a run's page shows of an arm: its designs side by side, simulated on the test set, at other
// speeds, and moving. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "problems/config/design_file.hpp"
#include "report/evidence/motions.hpp"
#include "report/evidence/page_options.hpp"
#include "report/evidence/recorded_run.hpp"

namespace armwright {

struct ShownDesign {
  NamedDesign named;
  std::string word;  // what `armwright evaluate` calls it: a name or a file; empty: nothing does
  std::optional<double> published_mean_m;
  std::optional<double> published_torque_n_m;
  std::string where;                    // that is published
  std::vector<TrackingResult> results;  // on the test set, one a case; empty: not simulated
};

// The winner (of a run under way the best so far), the design it started from and the published
// one, as far as there are such and they suit the robot; `notes` get what does not.
std::vector<ShownDesign> list_designs(const RecordedRun& run, std::vector<std::string>& notes);

// Every design on the whole test set.
void simulate_designs(const RecordedRun& run, PageSimulator& simulator,
                      std::vector<ShownDesign>& designs);

// TestErrors, or null if the run has no result. Without simulated designs those that the run
// recorded of its winner.
nlohmann::json make_test_errors(const RecordedRun& run, const std::vector<ShownDesign>& designs);

// ArmEvidence; `simulator` null: no sweep. `notes` get what that leaves out.
nlohmann::json make_arm_evidence(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                                 PageSimulator* simulator, std::vector<std::string>& notes);

// How many cases the sweep of make_arm_evidence() simulates.
std::uint64_t count_sweep_cases(const RecordedRun& run, const std::vector<ShownDesign>& designs);

// Which cases to replay, none twice: a training case, of the test set the first, the median, the
// 95th percentile and the worst of the winner, its first failures, and those that were asked for.
// Error{usage} if one of those is none.
std::vector<ReplayRequest> choose_replays(const RecordedRun& run,
                                          const std::vector<ShownDesign>& designs,
                                          const std::vector<std::string>& asked_for);

}  // namespace armwright
