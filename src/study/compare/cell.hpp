// Runs one cell of a comparison and evaluates its designs on the test set, which no optimizer sees.
// The cell's curve shows the incumbents at certain budgets. They are simulated again on the test
// set, so a curve shows true quality and not luck in training.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"
#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// Returns the value of a design on the test set, to be minimised: the (scalar) objective. The value
// is infinite without an objective, with a failed case, or with a constraint violation above
// `tolerance`.
double calc_test_value(const ProblemDescription& problem, const Evaluation& evaluation,
                       double tolerance);

// One point of a cell's curve: a budget and the design that belongs to it.
struct CurvePoint {
  std::int64_t budget = 0;  // simulated training cases
  double value = 0;         // on the test set; infinite while the run has no design
  // Number of test cases in which the design fails; all of them while the run has no design. Empty
  // for cells that were recorded by versions which did not count failures.
  std::optional<std::uint64_t> failures;
};

// CellOutcome::end_reason of a cell that has not ended; no cell.json has it.
inline constexpr const char* kNotEnded = "not ended";

// The record of a finished cell (cell.json).
struct CellOutcome {
  std::string problem;    // label
  std::string optimizer;  // label
  std::string optimizer_name;
  int replicate = 1;
  std::string configuration_sha256;  // of the problem
  std::string end_reason;
  std::string failure;  // the optimizer's error; empty if it did not fail
  std::uint64_t evaluations = 0;
  std::uint64_t cases = 0;  // charged to the budget
  std::uint64_t clipped = 0;
  std::uint64_t failed_evaluations = 0;
  // The winner, chosen on the validation set. All values are infinite if there is no winner.
  std::vector<double> x;
  double validation_value = 0;
  double value = 0;
  double violation = 0;  // sum of max(0, g) on the test set
  ErrorSummary errors;   // on the test set
  std::vector<double> objectives;
  std::vector<double> metrics;
  // The start point, which is the same for all optimizers.
  double start_value = 0;
  std::optional<std::uint64_t> start_failures;  // as CurvePoint::failures
  std::vector<CurvePoint> curve;                // the incumbents at the checkpoints
  // The run's incumbents, each with the number of cases when it was found (incumbents.hpp). Arms
  // have at most kMostTraced of them, and those of the curve.
  std::vector<CurvePoint> trace;
  // Only for plans with targets: the winner on the validation set if the run had ended at that
  // budget (choices.hpp).
  std::vector<CurvePoint> choices;
  // Only for several objectives: the objectives on the test set of all judged designs that have a
  // value there.
  std::vector<std::vector<double>> front;
  // The number of candidates that were judged on the validation set at the end of the run. Not in
  // cell.json: count_judged() reads it from the run's result. Empty if that file is missing.
  std::optional<std::uint64_t> judged;
};

// Returns the text of cell.json.
std::string to_json(const CellOutcome& outcome);
// Reads the text of a cell.json. Throws Error{bad_data} with the name of `file`.
CellOutcome parse_cell(const std::string& json, const std::filesystem::path& file);

// Returns how many candidates the run in this folder judged on the validation set at its end;
// nothing if it has no result.json. Throws Error{bad_data} if that file cannot be read.
std::optional<std::uint64_t> count_judged(const std::filesystem::path& folder);

// Runs the cell or resumes it. Writes cell.json last, so a cell that has this file is finished.
// Returns nothing if `stop` ended the cell.
std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const std::filesystem::path& study, StopSignal& stop,
                                    RunObserver& observer);

// Where and how to run a cell. None of this changes the outcome.
struct CellRequest {
  std::filesystem::path folder;
  std::filesystem::path root = {};  // that the user named and that holds `folder`; empty: `folder`
  unsigned jobs = 1;                // threads
  std::vector<std::string> command_line = {};  // for the manifest
  CaseExecutor* executor = nullptr;  // used instead of `jobs` threads; not owned; may be null
};
std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const CellRequest& where, StopSignal& stop,
                                    RunObserver& observer);

// Returns the recorded outcome of a cell. Returns nothing if the cell has not ended, or if
// its record lacks values that the plan asks for now. In the latter case run_cell() adds them from
// the journal.
// Throws Error{bad_data} if the record belongs to another cell or cannot be read.
std::optional<CellOutcome> load_cell(const StudyPlan& plan, const Cell& cell,
                                     const std::filesystem::path& study);

}  // namespace armwright
