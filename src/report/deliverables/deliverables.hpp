// Makes files for the arm's maker from one finished run: the winner as controllers of ROS 2, as the
// robot's description with new effort limits, and as a data sheet.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "report/evidence/recorded_run.hpp"

namespace armwright {

// A finished run of an arm, and its winner.
struct FinishedArm {
  RecordedRun run;   // with its result, a winner and the arm's problem
  ArmDesign design;  // the winner
  // Sentences that stand in every file, without control characters: the winner's faults
  // (list_faults()), and the conditions under which it is not shown to work (list_weaknesses()), or
  // that it was not checked.
  std::vector<std::string> warnings;

  const TrackingConfig& config() const { return run.tracking()->config(); }
  const RunResult& result() const { return *run.result; }
  const JudgedCandidate& winner() const { return result().judged[*result().winner]; }
  // Returns "the winner of ga (seed 1) on q1-complex" without control characters.
  std::string describe() const;
  // Returns whether integrals hold the arm against gravity from the first control period on: the task
  // wants it, and the controllers' law and gains allow it.
  bool starts_held() const;
};

// Throws Error{usage} for a study, for a run of an analytic function, and for a run that has not
// ended or has no winner; the message says which folder `format` (of --format) needs. Also throws
// Error{usage} if the winner has faults (list_faults()), unless `force`. Throws
// Error{bad_data} if files have changed, so that the robot of the run is not known, and what
// load_check() throws.
FinishedArm load_finished_arm(const std::filesystem::path& folder, std::string_view format,
                              bool force);

// Each of the writers throws Error{io} if a file cannot be written.

// Writes controllers-DISTRIBUTION.yaml for each distribution. Throws what make_ros2_control()
// throws.
void write_ros2_control(const FinishedArm& arm, const std::filesystem::path& folder);

// Writes the robot's own file under its own name. The effort limit of each joint becomes the larger
// of the design's two limits (sim/robot/urdf_writer.hpp). Throws Error{usage} if the winner changes
// the size of links, because the export keeps links and meshes; Error{bad_data} if the file is not
// the one that the run used.
void write_urdf(const FinishedArm& arm, const std::filesystem::path& folder);

// Writes datasheet.html.
void write_datasheet(const FinishedArm& arm, const std::filesystem::path& folder);

// Returns the data sheet as one HTML file for one page of A4. It has no scripts and loads nothing.
// The same run gives the same bytes on every day.
std::string make_datasheet(const FinishedArm& arm);

inline constexpr double kMillimetresPerMetre = 1000;  // the files show errors in mm

}  // namespace armwright
