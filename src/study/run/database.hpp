// A run's journal as an SQLite file, for queries. Derived: it can be removed and rebuilt at any
// time.
//   variable(position, name, unit, lower, upper, start)
//   evaluation(role, number, generation, status, reason, clipped, set_name, first_case, cases,
//              objective, x, metrics)      objective: of several, the weighted sum
//     role: training, validation or test; x and metrics: JSON arrays in the order of those tables
//   metric(position, name, unit)
//   case_error(role, number, case_number, error)     error is NULL where a simulation yielded none
#pragma once

#include <filesystem>

#include "problems/interface/problem.hpp"
#include "study/journal/journal.hpp"

namespace armwright {

// Replaces `file` in one step. Error{io} with SQLite's reason if it cannot be written.
void write_database(const std::filesystem::path& file, const ProblemDescription& problem,
                    const JournalContent& journal);

}  // namespace armwright
