// A study as text: its plan before it runs, and its tables and verdict when its cells have ended.
#pragma once

#include <filesystem>
#include <string>

#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/analysis/study_result.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {

// Returns a table of the problems, the optimizers, the budget and what is paired.
std::string describe_plan(const StudyPlan& plan);
// Says which differences the study can find with its replicates, after Holm's correction over all
// pairs of a problem, and how many replicates a medium difference needs (study/statistics/power.hpp).
// Warns if no outcome can be significant. Empty if there is nothing to compare.
std::string describe_power(const StudyPlan& plan);
// Returns the number of cells and of simulated cases. If `expected_s` is above 0, the expected time
// with `jobs` threads is added.
std::string describe_cost(const StudyPlan& plan, double expected_s, unsigned jobs);

// Returns one table per problem, the ranking over all problems, the verdict, and the commands that
// show the best winners, for standard output.
std::string describe_study(const StudyPlan& plan, const StudyResult& result,
                           const std::filesystem::path& folder, const Session& session);

// Ends a command that has all cells of a study: analyzes them, simulates the final checks with
// `jobs` threads, writes the tables and prints the result (`as_json`: as JSON). The caller holds
// the folder's lock. A cell that has not ended counts as a run that found nothing. Returns the exit
// code. Throws Error{bad_data} or Error{io} if a cell cannot be read or a table cannot be written.
int end_study(const StudyPlan& plan, const std::filesystem::path& folder, unsigned jobs,
              bool as_json, Session& session, ProgressBar& bar);

}  // namespace armwright
