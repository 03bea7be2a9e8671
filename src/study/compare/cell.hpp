// One cell of a comparison: a run, and what its designs are worth where no optimizer has been, on
// the test set. Curves show the incumbents at certain budgets, re-simulated there: true quality,
// not luck in training.
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

// The value of a design on the test set, to be minimised: the (scalar) objective; infinite if it
// has none, if a case is without number, or if a constraint is violated by more than `tolerance`.
double calc_test_value(const ProblemDescription& problem, const Evaluation& evaluation,
                       double tolerance);

struct CurvePoint {
  std::int64_t budget = 0;
  double value = 0;  // of the incumbent at that budget; infinite before there is one
  // Test cases in which it fails, all before there is one; nothing in cells of versions before
  // these were recorded.
  std::optional<std::uint64_t> failures;
};

struct CellOutcome {
  std::string problem;    // label
  std::string optimizer;  // label
  std::string optimizer_name;
  int replicate = 1;
  std::string configuration_sha256;  // of the problem
  std::string end_reason;
  std::string failure;  // of the optimizer; empty if it did not fail
  std::uint64_t evaluations = 0;
  std::uint64_t cases = 0;  // of the budget
  std::uint64_t clipped = 0;
  std::uint64_t failed_evaluations = 0;
  // The winner, as chosen on the validation set. Without one all values are infinite.
  std::vector<double> x;
  double validation_value = 0;
  double value = 0;
  double violation = 0;  // sum of max(0, g) on the test set
  ErrorSummary errors;   // on the test set
  std::vector<double> objectives;
  std::vector<double> metrics;
  // The place that all optimizers started from.
  double start_value = 0;
  std::optional<std::uint64_t> start_failures;  // as in CurvePoint
  std::vector<CurvePoint> curve;
  // Of a plan with targets: the winner that the run would have had if it had ended at that budget,
  // by the validation set (choices.hpp).
  std::vector<CurvePoint> choices;
  // Several objectives: those of all judged designs on the test set that have a value there.
  std::vector<std::vector<double>> front;
};

std::string to_json(const CellOutcome& outcome);
CellOutcome parse_cell(const std::string& json, const std::filesystem::path& file);

// Runs the cell, or goes on with it, and writes cell.json last: where that is, nothing is left to
// do. Nothing if stopped.
std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const std::filesystem::path& study, StopSignal& stop,
                                    RunObserver& observer);

// The same in any folder and on several threads, which changes nothing of what it finds.
struct CellRequest {
  std::filesystem::path folder;
  unsigned jobs = 1;
  std::vector<std::string> command_line = {};  // for the manifest
  CaseExecutor* executor = nullptr;            // instead of `jobs` threads of its own
};
std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const CellRequest& where, StopSignal& stop,
                                    RunObserver& observer);
// What is recorded of a cell; nothing if it has not ended, or was recorded before the plan asked
// for what it lacks, which run_cell() adds from its journal. Error{bad_data} if it is another
// one's.
std::optional<CellOutcome> load_cell(const StudyPlan& plan, const Cell& cell,
                                     const std::filesystem::path& study);

}  // namespace armwright
