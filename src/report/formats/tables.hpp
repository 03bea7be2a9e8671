// Runs as tables, for spreadsheets and scripts: CSV (RFC 4180) and JSON. Both bear every evaluation
// with every digit, and `armwright import` reads both.
//
// CSV, in the folder:
//   runs.csv                    a row a run: problem, label, optimizer, replicate, seed, ...
//   evaluations/PROBLEM.csv     a row an evaluation: problem, label, optimizer, replicate,
//                               evaluation, simulated_cases, status, feasible, objective, then
//                               objective.NAME, constraint.N, metric.NAME and x.NAME of each;
//                               what does not exist is empty
//   designs/PROBLEM-LABEL-REPLICATE.toml    the winner of each run on an arm
//   test-cases/PROBLEM.json     what the winners were tested on
// JSON: runs.json and the same test cases. Numbers that do not exist are null.
#pragma once

#include <filesystem>

#include "report/formats/run_traces.hpp"

namespace armwright {

inline constexpr const char* kRunsCsv = "runs.csv";
inline constexpr const char* kEvaluationsFolder = "evaluations";
inline constexpr const char* kRunsJson = "runs.json";

void write_csv(const Survey& survey, const std::filesystem::path& folder);
void write_json(const Survey& survey, const std::filesystem::path& folder);

// For each problem with arms, the cases that its winners were tested on, as `armwright evaluate
// --test-cases` reads them. Sets that came from a file are left out: there is one already.
void write_test_cases(const Survey& survey, const std::filesystem::path& folder);

}  // namespace armwright
