// A run's result as optimize prints it at its end and show at any time.
#pragma once

#include <filesystem>
#include <string>

#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "problems/config/design_file.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

// What was done, the winner, what the test set says of it, published numbers beside ours, and where
// the files lie.
std::string describe_result(const RunResult& result, const std::filesystem::path& folder,
                            const Style& style);

// The designs that were judged on the validation set, a line each.
std::string describe_judged(const RunResult& result, const Style& style);

// A design's gains and limits, a line a joint.
std::string format_design(const DesignFile& design, const Style& style);

// Mean, median, 95th percentile, worst and failures, a row each; others may follow.
Table make_summary_table(const ErrorSummary& summary);

// The exit code of a run that has come to its end: kFailed if it found nothing feasible or its
// winner has cases without a number.
int get_result_code(const RunResult& result);

}  // namespace armwright
