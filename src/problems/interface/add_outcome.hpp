// How every problem makes an evaluation's status and errors of the outcomes of its cases.
#pragma once

#include <limits>

#include "problems/interface/problem.hpp"

namespace armwright {

// Appends the error of one case, NaN if it has none. The evaluation gets the status and the reason of
// the first case that is not ok, or of the first one that was abandoned, because the numbers are then
// only bounds. Returns whether the case has an error. Call it in the order of the cases.
inline bool add_outcome(const CaseOutcome& outcome, Evaluation& evaluation) {
  const bool is_first_abandoned = outcome.status == EvaluationStatus::abandoned &&
                                  evaluation.status != EvaluationStatus::abandoned;
  if (is_first_abandoned ||
      (outcome.status != EvaluationStatus::ok && evaluation.status == EvaluationStatus::ok)) {
    evaluation.status = outcome.status;
    evaluation.reason = outcome.reason;
  }
  evaluation.case_errors.push_back(outcome.has_error ? outcome.error
                                                     : std::numeric_limits<double>::quiet_NaN());
  evaluation.failed_cases += outcome.has_error ? 0 : 1;
  return outcome.has_error;
}

}  // namespace armwright
