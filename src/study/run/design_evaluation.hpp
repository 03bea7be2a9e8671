// A given design on a set of test cases, with progress: what evaluate, sweep, verify and reproduce
// have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

struct ChosenCases {
  TestSet set;
  std::uint64_t count = 0;
};

// The problem's tracking side; Error{usage} for an analytic function, which no arm's design can be
// evaluated on.
const TrackingProblem& require_tracking(const LoadedProblem& problem);

struct DesignEvaluation {
  std::vector<TrackingResult> results;  // one a case
  // Likewise, of each requirement of the problem.
  std::vector<std::vector<RequiredValue>> required;
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

// The same without keeping what every case was like, for as many cases as one likes.
struct ErrorSurvey {
  ErrorSummary summary;
  std::uint64_t first_failure = 0;  // of summary.failures, if there are any
  std::string reason;               // why the first case without a number has none
};
std::optional<ErrorSurvey> survey_with_progress(const TrackingProblem& problem,
                                                const ArmDesign& design, const ChosenCases& cases,
                                                unsigned jobs, StopSignal& stop,
                                                RunObserver& observer, BarShare share);

// The error of a case, if it has one.
std::optional<double> get_error(const TrackingResult& result);

// A case without a number, and why it has none.
struct CaseFailure {
  std::uint64_t number = 0;
  std::string reason;
};
std::vector<CaseFailure> list_failures(std::span<const TrackingResult> results);

}  // namespace armwright
