#include "study/design_evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>

#include "base/error.hpp"

namespace armwright {

const TrackingProblem& require_tracking(const LoadedProblem& problem) {
  if (problem.tracking == nullptr) {
    throw Error(
        ErrorKind::usage,
        fmt::format("problem '{}' is an analytic function, on which no arm can be evaluated; "
                    "choose a robot problem (armwright list problems)",
                    problem.name));
  }
  return *problem.tracking;
}

std::optional<double> get_error(const TrackingResult& result) {
  return result.status == SimulationStatus::ok ? std::optional(result.mean_error_m) : std::nullopt;
}

std::optional<DesignEvaluation> evaluate_with_progress(const TrackingProblem& problem,
                                                       const ArmDesign& design,
                                                       const ChosenCases& cases, unsigned jobs,
                                                       StopSignal& stop, RunObserver& observer,
                                                       BarShare share) {
  // Between two looks at the progress: enough to occupy all threads.
  constexpr std::uint64_t kCasesPerJob = 10;
  constexpr std::uint64_t kBatchesPerJob = 4;
  const std::uint64_t at_once =
      jobs * std::max<std::uint64_t>(kCasesPerJob,
                                     kBatchesPerJob * problem.batch_size(CaseRole::test).largest);
  Progress progress;
  progress.phase = Progress::Phase::test;
  progress.done = share.done_before;
  progress.total = share.total;
  observer.on_progress(progress);
  DesignEvaluation evaluation;
  while (evaluation.results.size() < cases.count) {
    const std::uint64_t first = evaluation.results.size();
    const std::uint64_t count = std::min(cases.count - first, at_once);
    auto results = evaluate_design(problem, design, cases.set, first, count, jobs, stop);
    if (!results) {
      return std::nullopt;
    }
    std::move(results->begin(), results->end(), std::back_inserter(evaluation.results));
    progress.done = share.done_before + evaluation.results.size();
    observer.on_progress(progress);
  }
  std::vector<double> errors;
  double energy_j = 0;
  double numbers = 0;
  for (const TrackingResult& result : evaluation.results) {
    const auto error = get_error(result);
    errors.push_back(error.value_or(std::numeric_limits<double>::quiet_NaN()));
    energy_j += error ? result.energy_j : 0;
    numbers += error ? 1 : 0;
  }
  evaluation.summary = summarize(errors, kFailureError_m);
  evaluation.total_torque_n_m = calc_total_torque_n_m(design);
  if (numbers > 0) {
    evaluation.mean_energy_j = energy_j / numbers;
  }
  return evaluation;
}

std::vector<CaseFailure> list_failures(std::span<const TrackingResult> results) {
  std::vector<CaseFailure> failures;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i].status != SimulationStatus::ok) {
      failures.push_back({i, results[i].reason});
    }
  }
  return failures;
}

}  // namespace armwright
