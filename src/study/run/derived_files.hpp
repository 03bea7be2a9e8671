// The files that are derived from a run's journal, for people and other programs: tables as CSV and
// SQLite, the winner as a design file and as a recorded motion. They can be removed and written
// again at any time.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "study/journal/journal.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

enum class DerivedFiles {
  all,
  winner  // winner.toml alone: a comparison makes its tables from all of its runs
};

// Returns a recorded motion as CSV, one row per control period: time, then for each joint its
// position, target and effort, then tip position, target position and error.
std::string make_trajectory_csv(const TrackingProblem& problem, const TrackingResult& result);

// Returns whether the folder has a result and all files that write_derived_files() would write for
// it, and their checksums if the run has begun with them. Throws Error{bad_data} if result.json is damaged.
bool are_derived_files_there(const RunFolder& folder, const RunPlan& plan, DerivedFiles derived);

// Writes the derived files, and result.json last: where it exists, all others exist. Calls
// `before_last` right before it. Then covers all files of the run with checksums. Throws Error{io}.
void write_derived_files(const RunFolder& folder, const RunPlan& plan, const RunResult& result,
                         JournalContent journal, DerivedFiles derived,
                         const std::function<void()>& before_last);

// Writes a journal as an SQLite file with these tables:
//   variable(position, name, unit, lower, upper, start)
//   metric(position, name, unit)
//   evaluation(role, number, generation, status, reason, clipped, set_name, first_case, cases,
//              objective, x, metrics)
//     role: training, validation or test; objective: of several, the weighted sum;
//     x and metrics: JSON arrays in the order of the tables variable and metric
//   case_error(role, number, case_number, error)     error is NULL if the simulation yielded none
// and, if the problem has discrete variables, also these:
//   discrete_variable(position, type, choices)
//     type: integer or category; choices: JSON array of the words of a category, whose number in x is
//     the place of the word, from 0
//   proposal(number, x)
//     the training evaluations whose decision vector was rounded, and what the optimizer asked for
// Replaces the file `name` in one step. Throws Error{io} with SQLite's reason if it cannot be
// written.
void write_database(const Folder& folder, const std::string& name,
                    const ProblemDescription& problem, const JournalContent& journal);

}  // namespace armwright
