// What somebody who stops a run early has of it: at each of some budgets the design that is best on
// the validation set of all that were candidates for the win then or at the budgets before. No
// incumbent, which is good in training, and not the best so far on the test set, which would be a
// selection there.
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

// Designs on the whole validation or test set of a problem, each but once.
class DesignBench {
 public:
  // All of these outlive it.
  DesignBench(const LoadedProblem& problem, CaseRole role, CaseExecutor& executor,
              StopSignal& stop);

  // False if stopped.
  bool add(std::span<const std::vector<double>> designs);
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

// A case of an arm fails with an error above kFailureError_m, one of a function never.
ErrorSummary summarize_errors(const LoadedProblem& problem, const Evaluation& evaluation);

struct Choice {
  std::int64_t budget = 0;
  // Nothing before there is a candidate.
  std::optional<JudgedCandidate> chosen;
};

// `training` is the run's journal, in order; `budgets` increase. The last choice has the run's own
// winner among its candidates; before, what an optimizer recommends without evaluating it, which no
// journal holds, is not. Nothing if stopped.
std::optional<std::vector<Choice>> make_choices(const RunPlan& run,
                                                const RecordedEvaluations& training,
                                                const RunResult& result,
                                                std::span<const std::int64_t> budgets,
                                                CaseExecutor& executor, StopSignal& stop);

}  // namespace armwright
