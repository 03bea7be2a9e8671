#include "study/run/design_evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "problems/user/user_problem.hpp"
#include "study/executor/thread_pool.hpp"

namespace armwright {

namespace {

// Simulates the cases and hands the results to `take`, batch by batch, in the order of the cases.
// Returns false if it was stopped.
template <class Take>
bool simulate_all(const TrackingProblem& problem, const ArmDesign& design, const ChosenCases& cases,
                  unsigned jobs, StopSignal& stop, RunObserver& observer, Progress progress,
                  const Take& take) {
  // The cases between two reports of the progress must occupy all threads.
  constexpr std::uint64_t kCasesPerJob = 10;
  constexpr std::uint64_t kBatchesPerJob = 4;
  const std::uint64_t at_once =
      jobs * std::max<std::uint64_t>(kCasesPerJob,
                                     kBatchesPerJob * problem.batch_size(CaseRole::test).largest);
  progress.phase = CaseRole::test;
  const std::uint64_t done_before = progress.done;
  observer.on_progress(progress);
  for (std::uint64_t first = 0; first < cases.count;) {
    const std::uint64_t count = std::min(cases.count - first, at_once);
    auto results =
        evaluate_design(problem, design, cases.set, first, count, jobs, cases.motion, stop);
    if (!results) {
      return false;
    }
    take(std::move(*results));
    first += count;
    progress.done = done_before + first;
    observer.on_progress(progress);
  }
  return true;
}

double get_number(const TrackingResult& result) {
  return get_error(result).value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

const TrackingProblem& require_tracking(const LoadedProblem& problem) {
  if (find_user_description(*problem.problem) != nullptr) {
    throw Error(ErrorKind::usage,
                fmt::format("problem '{}' is one of your own and has no arm. 'armwright evaluate "
                            "winner.toml --problem PROBLEM' evaluates its designs, and 'armwright "
                            "report' shows its runs",
                            problem.name));
  }
  if (problem.tracking() == nullptr) {
    throw Error(
        ErrorKind::usage,
        fmt::format("problem '{}' is an analytic function, on which no arm can be evaluated; "
                    "choose a robot problem (armwright list problems)",
                    problem.name));
  }
  return *problem.tracking();
}

std::optional<std::vector<MeasuredCase>> evaluate_design(const TrackingProblem& problem,
                                                         const ArmDesign& design,
                                                         const TestSet& set, std::uint64_t first,
                                                         std::uint64_t cases, unsigned jobs,
                                                         bool motion, StopSignal& stop) {
  problem.check_design(design);
  std::vector<MeasuredCase> results(cases);
  ThreadPool pool(jobs);
  const std::size_t chunk = calc_chunk(problem.batch_size(CaseRole::test), cases, pool.size());
  pool.run((results.size() + chunk - 1) / chunk, [&](std::size_t number) {
    if (!stop.requested()) {
      const std::size_t begin = number * chunk;
      const std::size_t count = std::min(chunk, results.size() - begin);
      std::ranges::move(problem.measure(design, set, first + begin, count, motion),
                        results.begin() + static_cast<std::ptrdiff_t>(begin));
    }
  });
  return stop.requested() ? std::nullopt : std::optional(std::move(results));
}

std::optional<double> get_error(const TrackingResult& result) {
  return result.status == SimulationStatus::ok ? std::optional(result.mean_error_m) : std::nullopt;
}

std::optional<DesignEvaluation> evaluate_with_progress(const TrackingProblem& problem,
                                                       const ArmDesign& design,
                                                       const ChosenCases& cases, unsigned jobs,
                                                       StopSignal& stop, RunObserver& observer,
                                                       Progress progress) {
  DesignEvaluation evaluation;
  MotionErrors motion;
  const auto keep = [&](std::vector<MeasuredCase> cases_measured) {
    for (MeasuredCase& one : cases_measured) {
      evaluation.results.push_back(std::move(one.result));
      evaluation.required.push_back(std::move(one.required));
      motion.add(one.motion);
    }
  };
  if (!simulate_all(problem, design, cases, jobs, stop, observer, progress, keep)) {
    return std::nullopt;
  }
  std::vector<double> errors;
  double energy_j = 0;
  double numbers = 0;
  for (const TrackingResult& result : evaluation.results) {
    const auto error = get_error(result);
    errors.push_back(get_number(result));
    energy_j += error ? result.energy_j : 0;
    numbers += error ? 1 : 0;
  }
  evaluation.summary = summarize(errors, kFailureError_m);
  evaluation.motion = motion.summarize();
  evaluation.efforts = calc_effort_totals(design, problem.config().robot);
  if (numbers > 0) {
    evaluation.mean_energy_j = energy_j / numbers;
  }
  return evaluation;
}

std::optional<ErrorSurvey> survey_with_progress(const TrackingProblem& problem,
                                                const ArmDesign& design, const ChosenCases& cases,
                                                unsigned jobs, StopSignal& stop,
                                                RunObserver& observer, Progress progress) {
  ErrorSurvey survey;
  std::vector<double> errors;
  bool failed = false;
  const auto take = [&](const std::vector<MeasuredCase>& measured) {
    for (const auto& [result, required, motion] : measured) {
      const double error = get_number(result);
      if (!failed && !(error <= kFailureError_m)) {
        failed = true;
        survey.first_failure = errors.size();
      }
      if (survey.reason.empty() && result.status != SimulationStatus::ok) {
        survey.reason = result.reason;
      }
      errors.push_back(error);
    }
  };
  if (!simulate_all(problem, design, cases, jobs, stop, observer, progress, take)) {
    return std::nullopt;
  }
  survey.summary = summarize(errors, kFailureError_m);
  return survey;
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
