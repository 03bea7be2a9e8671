// Reads from a run's manifest which function the run optimized, and that function's smallest value.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace armwright {

struct RunResult;

// The function that a run optimized. Two runs with equal `problem` and `settings` optimized the
// same function, possibly with other numbers of variables.
struct RecordedFunction {
  std::string problem;   // the problem's own name, "sphere"; a study may give it another label
  std::string settings;  // JSON: the recorded settings that decide an objective
  // The smallest value of the scalar objective, of this run's instance; nothing if unknown.
  std::optional<double> optimum;
};

// `result` is that of the run in `folder`. Throws Error{io} if the manifest cannot be read,
// Error{bad_data} if it is not what armwright wrote, and what load_recorded_problem() throws.
RecordedFunction read_function(const std::filesystem::path& folder, const RunResult& result);

// Returns RecordedFunction::settings of a problem's resolved configuration. Leaves out titles, the
// number of variables, the instance if each replicate has its own, start, budget, schedule and sets
// of cases, and the SIMD level. Throws Error{bad_data} for a text that is not such a configuration.
std::string make_function_settings(const std::string& resolved_json);

}  // namespace armwright
