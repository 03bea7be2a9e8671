#include "cli/design_evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/format.hpp"
#include "cli/terminal.hpp"

namespace armwright {
namespace {

constexpr std::int64_t kMostCases = 1'000'000;

TestSet choose_set(const LoadedProblem& problem, const CaseOptions& options) {
  if (!options.test_cases.empty()) {
    return TestSet::load(options.test_cases);
  }
  const TrackingProblem& tracking = require_tracking(problem);
  if (options.test_set.empty()) {
    return tracking.get_set(problem.sets.test);
  }
  const bool complete = options.test_set.find('/') != std::string::npos;
  return tracking.get_set(complete ? options.test_set : "test/" + options.test_set);
}

}  // namespace

LoadedProblem load_its_problem(const DesignFile& design, const std::string& problem,
                               std::vector<std::string> overrides, bool quiet) {
  if (!problem.empty()) {
    return load_problem(problem, overrides);
  }
  if (design.published.empty()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("--problem is missing, and design '{}' does not say what it was made for; "
                    "name one (armwright list problems)",
                    sanitize(design.name)));
  }
  const PublishedResult& published = design.published.front();
  overrides.insert(overrides.begin(), published.overrides.begin(), published.overrides.end());
  if (!quiet) {
    write_message(fmt::format("no --problem given: using {}, which {} was published for",
                              published.problem, design.name));
  }
  return load_problem(published.problem, overrides);
}

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

ChosenCases choose_cases(const LoadedProblem& problem, const CaseOptions& options) {
  TestSet set = choose_set(problem, options);
  const auto usual = set.size().value_or(static_cast<std::uint64_t>(problem.sets.test_cases));
  const auto count =
      options.cases.empty()
          ? usual
          : static_cast<std::uint64_t>(parse_count("--cases", options.cases, 1, kMostCases));
  if (set.size() && count > *set.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("--cases is {}, but {} holds {}", count, sanitize(options.test_cases),
                            format_count(*set.size(), "case")));
  }
  return {std::move(set), count};
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

void report_failures(const DesignEvaluation& evaluation, const std::string& what) {
  constexpr int kMostNamed = 5;
  int found = 0;
  for (std::size_t i = 0; i < evaluation.results.size(); ++i) {
    const TrackingResult& result = evaluation.results[i];
    if (result.status == SimulationStatus::ok || ++found > kMostNamed) {
      continue;
    }
    write_message(fmt::format("{}case {}: {}", what, i, result.reason));
  }
  if (found > kMostNamed) {
    write_message(fmt::format("{}and {} more cases without a number", what, found - kMostNamed));
  }
}

}  // namespace armwright
