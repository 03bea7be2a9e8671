// Determines the design that a user would get who stops a run early. At each given budget this is
// the design that is best on the validation set. It is chosen among all designs that were
// candidates for the winner at that budget or at an earlier one. The incumbent would not do: it is
// the best in training. Neither would the best design on the test set so far: that would be a
// selection on the test set.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "study/executor/case_executor.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

// Evaluates designs on the whole validation or test set of a problem, each design only once.
class DesignBench {
 public:
  // Keeps references to all arguments; they must outlive this object.
  DesignBench(const LoadedProblem& problem, CaseRole role, CaseExecutor& executor,
              StopSignal& stop);

  // Evaluates the designs that are new. Returns false if stopped.
  bool add(std::span<const std::vector<double>> designs);
  // Returns the evaluation of a design that was added before.
  const Evaluation& get(std::span<const double> x) const { return *find(x); }

 private:
  const Evaluation* find(std::span<const double> x) const;

  const Problem& problem_;
  CaseExecutor& executor_;
  StopSignal& stop_;
  CaseBlock block_;
  std::vector<std::vector<double>> designs_;
  std::vector<Evaluation> evaluations_;
};

// Summarises the errors of an evaluation. A case of an arm fails if its error is above
// kFailureError_m. A case of a function never fails.
ErrorSummary summarize_errors(const LoadedProblem& problem, const Evaluation& evaluation);

// Returns one choice per budget; it is empty where the run has no candidate yet. Returns nothing if
// stopped. `training` holds the run's journal in order; `budgets` must increase. The last choice
// has the run's own winner among its candidates. Earlier choices lack designs that an optimizer
// recommends without evaluating them, because no journal records these.
std::optional<std::vector<std::optional<JudgedCandidate>>> make_choices(
    const RunPlan& run, const RecordedEvaluations& training, const RunResult& result,
    std::span<const std::int64_t> budgets, CaseExecutor& executor, StopSignal& stop);

}  // namespace armwright
