// Evaluates a given design of a tracking problem on a set of test cases. The commands evaluate,
// sweep, verify and reproduce share these functions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/stop_signal.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/run/run_observer.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

// The first `count` cases of a test set.
struct ChosenCases {
  TestSet set;
  std::uint64_t count = 0;
  bool motion = false;  // whether the errors of the motion are measured, too
};

// Returns the tracking problem of a problem. Throws Error{usage} for an analytic function, which
// has no arm.
const TrackingProblem& require_tracking(const LoadedProblem& problem);

// Evaluates a design on the cases first, ..., first + cases - 1 of a set, on `jobs` threads.
// Returns one result per case, with the values of the problem's requirements and, with `motion`, the
// errors of the motion, or nothing if stopped. Throws Error{usage} if the design does not fit the problem.
std::optional<std::vector<MeasuredCase>> evaluate_design(const TrackingProblem& problem,
                                                         const ArmDesign& design,
                                                         const TestSet& set, std::uint64_t first,
                                                         std::uint64_t cases, unsigned jobs,
                                                         bool motion, StopSignal& stop);

struct DesignEvaluation {
  std::vector<TrackingResult> results;               // one per case
  std::vector<std::vector<RequiredValue>> required;  // per case, one per requirement
  ErrorSummary summary;
  std::optional<MotionSummary> motion;  // over the cases with an error
  EffortTotals efforts;
  std::optional<double> mean_energy_j;  // over the cases with an error
};

// As evaluate_design(), and reports the progress to `observer`. `progress` is the state before:
// done and total count all evaluations that share one progress bar. Returns nothing if stopped.
std::optional<DesignEvaluation> evaluate_with_progress(const TrackingProblem& problem,
                                                       const ArmDesign& design,
                                                       const ChosenCases& cases, unsigned jobs,
                                                       StopSignal& stop, RunObserver& observer,
                                                       Progress progress);

// A summary that does not keep the cases, for any number of them.
struct ErrorSurvey {
  ErrorSummary summary;
  std::uint64_t first_failure = 0;  // the first of summary.failures, if there are any
  std::string reason;               // why the first case without an error has none
};
// As evaluate_with_progress().
std::optional<ErrorSurvey> survey_with_progress(const TrackingProblem& problem,
                                                const ArmDesign& design, const ChosenCases& cases,
                                                unsigned jobs, StopSignal& stop,
                                                RunObserver& observer, Progress progress);

// Returns the mean error of a case in metres, or nothing if its simulation failed.
std::optional<double> get_error(const TrackingResult& result);

// A case without an error, and the reason.
struct CaseFailure {
  std::uint64_t number = 0;
  std::string reason;
};
std::vector<CaseFailure> list_failures(std::span<const TrackingResult> results);

}  // namespace armwright
