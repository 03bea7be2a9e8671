// A given design on a set of test cases, with progress on stderr: what evaluate, sweep,
// verify and reproduce have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments.hpp"
#include "problems/design_file.hpp"
#include "study/run.hpp"
#include "study/summary.hpp"

namespace armwright {

struct ChosenCases {
  TestSet set;
  std::uint64_t count = 0;
};

// Error{usage} if there are not so many cases.
ChosenCases choose_cases(const LoadedProblem& problem, const CaseOptions& options);

// The problem of that name; if there is none, the one that the design was published for, saying so
// on stderr unless `quiet`. Error{usage} if the design was published for none.
LoadedProblem load_its_problem(const DesignFile& design, const std::string& problem,
                               std::vector<std::string> overrides, bool quiet);

// The problem's tracking side; Error{usage} for an analytic function, which no arm's design can be
// evaluated on.
const TrackingProblem& require_tracking(const LoadedProblem& problem);

struct DesignEvaluation {
  std::vector<TrackingResult> results;  // one a case
  ErrorSummary summary;
  double total_torque_n_m = 0;
  std::optional<double> mean_energy_j;  // over the cases that ran to their end
};

// Where an evaluation stands among those that share one progress bar.
struct BarShare {
  std::uint64_t done_before = 0;
  std::uint64_t total = 0;
};

// Nothing if it was stopped.
std::optional<DesignEvaluation> evaluate_with_progress(const TrackingProblem& problem,
                                                       const ArmDesign& design,
                                                       const ChosenCases& cases, unsigned jobs,
                                                       StopSignal& stop, RunObserver& observer,
                                                       BarShare share);

// Every case without a number, named with its reason on stderr (the first few of them).
void report_failures(const DesignEvaluation& evaluation, const std::string& what);

// The error of a case, if it has one.
std::optional<double> get_error(const TrackingResult& result);

}  // namespace armwright
