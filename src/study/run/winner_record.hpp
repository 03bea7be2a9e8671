// What the first test case of a run's winner leaves beside its numbers (Problem::record_case):
// signals in winner-record.csv and files in the folder winner-files. Reports read them and simulate
// nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/folder.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

inline constexpr const char* kWinnerRecord = "winner-record.csv";

// Returns whether winner.toml holds the values of decision variables: for users' problems and planned
// motions. That of an arm holds a design.
bool has_values(const Problem& problem);
// Returns whether the run records its winner: the problem plans a motion, or is the user's and says
// that it has records. A run of ask and tell has none, because armwright does not simulate it.
bool has_record(const RunPlan& plan);
// Returns whether the folder has what write_record_files() has written, or needs none.
bool are_record_files_there(const RunFolder& folder, const RunPlan& plan);
// Simulates the first test case again and writes what it leaves, with checksums. Throws what
// Problem::record_case() throws, Error{bad_data} for the name of a file that is no plain name, and
// Error{io}.
void write_record_files(const Folder& folder, const RunPlan& plan, const std::vector<double>& x);

// Returns the signals as CSV: the abscissa and then one column per signal, with units.
std::string make_record_csv(const CaseRecord& record);

}  // namespace armwright
