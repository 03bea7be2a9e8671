// What is derived from a run's journal for people and other programs to read: tables as CSV and
// SQLite, the winner as a design file and as a recorded motion. All of it can be removed and
// rebuilt.
#pragma once

#include "study/journal/journal.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

// What is derived from a run for people to read beside its result.
enum class DerivedFiles {
  all,
  winner  // winner.toml alone: of a comparison's many runs, whose tables are made of all of them
};

// A recorded motion, a row a control period: time, each joint's angle, target and effort, tip,
// target and error.
std::string make_trajectory_csv(const TrackingProblem& problem, const TrackingResult& result);

// Whether everything that write_derived_files() makes is there, so that nothing needs rebuilding.
bool are_derived_files_there(const std::filesystem::path& folder, DerivedFiles derived);

// Writes result.json last, so that its presence says that the rest is there.
void write_derived_files(const RunFolder& folder, const RunPlan& plan, const RunResult& result,
                         JournalContent journal, DerivedFiles derived);

}  // namespace armwright
