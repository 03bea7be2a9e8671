// Collects what a run's page shows of an arm: its designs compared, simulated on the test set, at
// other speeds, and in motion. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "problems/config/design_file.hpp"
#include "report/evidence/motions.hpp"
#include "report/evidence/recorded_run.hpp"

namespace armwright {

// A design on the page of a run.
struct ShownDesign {
  NamedDesign named;
  std::string argument;  // its name or file for `armwright evaluate`; empty: it has neither
  std::string source;    // "thesis, Table A.5"; empty if its file names none
  std::optional<double> published_mean_m;
  std::optional<double> published_torque_n_m;
  std::string where;                    // the source of the published numbers
  std::vector<TrackingResult> results;  // on the test set, one per case; empty: not simulated
};

// Returns the winner (for an unfinished run the incumbent), the start and the published design, as
// far as they exist and fit the robot. `notes` gets a sentence for each one that does not fit.
std::vector<ShownDesign> list_designs(const RecordedRun& run, std::vector<std::string>& notes);

// Simulates every design on the whole test set. Throws WorkStopped.
void simulate_designs(const RecordedRun& run, PageSimulator& simulator,
                      std::vector<ShownDesign>& designs);

// Returns TestErrors of web/src/data.ts, or null if the run has no result. If no designs were
// simulated, it has only the errors that the run recorded of its winner.
nlohmann::json make_test_errors(const RecordedRun& run, const std::vector<ShownDesign>& designs);

// Returns ArmEvidence of web/src/data.ts. Without a simulator (null) it has no sweep. `notes` gets
// a sentence for each design that the sweep leaves out. Throws WorkStopped.
nlohmann::json make_arm_evidence(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                                 PageSimulator* simulator, std::vector<std::string>& notes);

// Returns Health of web/src/data.ts: the winner's results on the whole test set, which it must have,
// its motion on the median case by error, which is simulated here, and the recorded check. Throws WorkStopped.
nlohmann::json make_health(const RecordedRun& run, const ShownDesign& winner,
                           PageSimulator& simulator);
inline constexpr std::uint64_t kHealthCases = 1;  // that make_health() simulates
// Returns the indices of the cases by error, the smallest first. A NaN counts as larger than every
// number; of equal errors the first case comes first.
std::vector<std::size_t> rank_by_error(const std::vector<double>& errors);

// Returns Sweep of web/src/data.ts: the designs at other mean speeds of the target, as in the
// thesis's Fig. 6.16. Returns null if there is nothing to sweep. Throws WorkStopped.
nlohmann::json make_speed_sweep(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                                PageSimulator& simulator, std::vector<std::string>& notes);
// Returns the number of cases that make_speed_sweep() simulates.
std::uint64_t count_sweep_cases(const RecordedRun& run, const std::vector<ShownDesign>& designs);

// Chooses the cases to replay, each at most once: from the test set, by the winner's error, the
// median, the 95th percentile and the worst; the winner's first failures; the first of the test
// set; a training case; and `case_ids`, which the user asked for. The page opens the first one.
// Throws Error{usage} if one of `case_ids` is not a case.
std::vector<ReplayRequest> choose_replays(const RecordedRun& run,
                                          const std::vector<ShownDesign>& designs,
                                          const std::vector<std::string>& case_ids);

}  // namespace armwright
