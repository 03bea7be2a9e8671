// A run's result as text. optimize prints it at the end of a run, and show at any time.
#pragma once

#include <filesystem>
#include <string>

#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "problems/config/design_file.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

// Returns the counts of the run, the winner, its errors on the test set, published numbers beside
// ours, the check of the winner, and the files in the run's folder.
std::string describe_result(const RunResult& result, const std::filesystem::path& folder,
                            const Style& style);

// Returns the result of result.json, with the recorded check of the winner, if there is one, as
// `winner.check`.
std::string make_result_json(const RunResult& result, const std::filesystem::path& folder);

// Returns a table with one row per design that was judged on the validation set.
std::string describe_judged(const RunResult& result, const Style& style);

// Returns a clause that says how much of the budget the optimizer left unused, and why if it has said
// so. For results with `unused_evaluations` above 0.
std::string describe_unused(const RunResult& result);

// Returns the heading "Next" and the commands that show the folder of a run or a study: its page, and
// its result as text.
std::string describe_reading(const std::filesystem::path& folder, const Session& session,
                             const Style& style);

// Returns a table of a design's gains and effort limits, one row per joint.
std::string format_design(const DesignFile& design, const Style& style);

// Returns a table with one row each for mean, median, 95th percentile, worst and failures, and for
// the errors in motion if they were measured. The caller may add rows.
Table make_summary_table(const ErrorSummary& summary, const std::optional<MotionSummary>& motion);
// Adds rows for the total torque and the total force, as far as the arm has them.
void add_efforts(const EffortTotals& efforts, Table& table);

// Returns the exit code of a finished run. It is kFailed if the optimizer failed, if the run found
// nothing feasible, or if the winner has cases without a number.
int get_result_code(const RunResult& result);

}  // namespace armwright
