// One finished run of an arm and its winner: what everything is made of that goes to the arm's
// maker (controllers, robot description, datasheet). Only .cpp files include this.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "report/evidence/recorded_run.hpp"

namespace armwright {

struct FinishedArm {
  RecordedRun run;   // with its result, a winner and the arm's problem
  ArmDesign design;  // the winner

  const TrackingConfig& config() const { return run.tracking()->config(); }
  const RunResult& result() const { return *run.result; }
  const JudgedCandidate& winner() const { return result().judged[*result().winner]; }
  // "the winner of ga (seed 1) on q1-complex", printable.
  std::string describe() const;
};

// Error{usage} for a study, the run of an analytic function, one that has not ended or found
// nothing, saying what to give instead of it to --format `format`; Error{bad_data} if files have
// changed since, so that the robot is not known any more.
FinishedArm load_finished_arm(const std::filesystem::path& folder, std::string_view format);

inline constexpr double kMillimetresPerMetre = 1000;  // errors are read in mm

}  // namespace armwright
