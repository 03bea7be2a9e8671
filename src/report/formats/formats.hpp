// Writes collected runs in the formats that other programs read, one function per format. The
// functions throw Error{io} if a file cannot be written, and what read_trace() throws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "report/formats/export_functions.hpp"
#include "report/formats/run_traces.hpp"

namespace armwright {

// ---- Tables for spreadsheets and scripts -------------------------------------------------------
// CSV (RFC 4180) and JSON hold every evaluation with every digit. `armwright import` reads both.
//
// The files of CSV:
//   runs.csv                    one row per run: problem, label, optimizer, replicate, seed, ...
//   evaluations/PROBLEM.csv     one row per evaluation: problem, label, optimizer, replicate,
//                               evaluation, simulated_cases, status, feasible, objective, then
//                               objective.NAME, constraint.N, metric.NAME and x.NAME for each of
//                               these, and proposed.NAME if the problem has discrete variables; a
//                               field without a value is empty
//   designs/PROBLEM-LABEL-REPLICATE.toml    the winner of each run on an arm
//   test-cases/PROBLEM.json     the test cases of the winners
// The files of JSON: runs.json and the same test cases. A number without a value is null.

inline constexpr const char* kRunsCsv = "runs.csv";
inline constexpr const char* kEvaluationsFolder = "evaluations";
inline constexpr const char* kRunsJson = "runs.json";

void write_csv(const CollectedRuns& runs, const std::filesystem::path& folder);
void write_json(const CollectedRuns& runs, const std::filesystem::path& folder);

// Writes, for each problem with an arm, the test cases of its winners in the form that `armwright
// evaluate --test-cases` reads. Leaves out sets that came from a file, because that file exists.
// Throws Error{bad_data} if the first run's manifest is not what armwright wrote.
void write_test_cases(const CollectedRuns& runs, const std::filesystem::path& folder);

// ---- IOHprofiler -------------------------------------------------------------------------------
// The JSON format of IOHprofiler, version 2 of its analyzer logger. Sources: Doerr, Wang, Ye, van
// Rijn, Bäck 2018, "IOHprofiler: a benchmarking and profiling tool for iterative optimization
// heuristics", arXiv:1810.05281; de Nobel et al. 2024, "IOHexperimenter", Evolutionary Computation
// 32(3).
//
//   LABEL/IOHprofiler_fN_NAME.json              one root folder per label; N is
//                                               ExportFunction::id; one scenario per number of
//                                               variables
//   LABEL/data_fN_NAME/IOHprofiler_fN_DIMd.dat  per run a header, and one row for the first
//                                               evaluation, each improvement and the last one
//
// raw_y is the objective of the row's evaluation, or the weighted sum of several objectives. It is
// `inf` if the evaluation is not feasible. A metric without a value is `None`. JSON has no
// infinity, so the largest double stands for the best of a run that found nothing feasible. The
// format has no place for the problem's label and the names of the variables; they are the keys
// "problem" and "variables" of the scenario, which readers ignore. iohinspector finds the beginning
// of a run by the row of evaluation 1.

void write_ioh(const CollectedRuns& runs, const std::filesystem::path& folder);

// Returns the names of the .dat file's columns before x0, x1, ...
std::vector<std::string> make_ioh_columns(const TraceNames& names);
// Returns a run's part of the .dat file, its header included.
std::string make_ioh_rows(const RunTrace& trace);

// ---- COCO --------------------------------------------------------------------------------------
// The data format "bbob-new2" of COCO as cocopp reads it. Source: Hansen, Auger, Ros, Mersmann,
// Tušar, Brockhoff 2021, "COCO: a platform for comparing continuous optimizers in a black-box
// setting", Optimization Methods and Software 36(1).
//
//   LABEL/bbobexp_fN.info                          N: ExportFunction::id, from 25 to 92; one block
//                                                  of three lines per number of variables
//   LABEL/data_fN/bbobexp_fN_DIMd.dat              a row where a level of the objective is reached
//   LABEL/data_fN/bbobexp_fN_DIMd.tdat             a row at certain numbers of evaluations
//   LABEL/data_fN/bbobexp_fN_DIMd.{rdat,mdat}      headers only: no restarts, no recommendations
//   run_cocopp.py                                  starts cocopp with the names of the functions
//
// The reference of a run is its function's smallest value if that is known (Fopt). Otherwise it is
// the best feasible objective of all exported runs on the problem (Fref), or 0 if nothing was
// feasible. An evaluation that is not feasible counts as 1e10 in both fitness columns, or as the
// next power of ten above all feasible objectives. With constraints, the column of g-values has one
// digit per constraint. The count of g-evaluations is 0, because one evaluation computes the
// objective and all constraints, and cocopp adds both counts.

inline constexpr const char* kCocoSuite = "armwright";
inline constexpr const char* kCocoScript = "run_cocopp.py";

// Throws Error{usage} for functions above kLastCocoFunction.
void write_coco(const CollectedRuns& runs, const std::filesystem::path& folder);

// Returns a Python program that makes cocopp's pages of the folder it lies in. It tells cocopp the
// suite, which cocopp does not know, with the functions' names and numbers of variables.
std::string make_coco_script(std::span<const ExportFunction> functions);

// Returns the least k with 10^(k/20) >= difference. Differences below 1e-8 count as 1e-8. A run
// reaches a new level when k gets smaller than before; its first evaluation always does.
int calc_coco_level(double difference);

// Returns whether .tdat has a row for the evaluation with this number (from 1): the number is the
// whole part of a 10^(k/20), or 1, 2 or 5 times a power of ten times the dimension.
bool is_coco_milestone(std::uint64_t evaluation, std::size_t dimension);

// Returns one digit per constraint: 0 for a satisfied one, then 1 up to 1e-7, 2 up to 1e-6, ...,
// 8 up to 1, and 9 above.
std::string format_constraint_digits(std::span<const double> constraint_values);

// Returns the objective of evaluations that are not feasible: 1e10, or the next power of ten above
// all feasible objectives of the problem.
double calc_coco_infeasible(const ProblemRuns& problem);

// Returns best - reference, or 0 where rounding has put `best` below a known smallest value.
double calc_coco_difference(double best, double reference);

// A run's part of the files.
struct CocoRun {
  std::string header;   // the line above the rows in all files
  std::string dat;      // rows
  std::string tdat;     // rows
  std::string summary;  // "1:200|3.1e-03": replicate, evaluations and best - reference
};
CocoRun make_coco_run(const RunTrace& trace, const ProblemRuns& problem);

}  // namespace armwright
