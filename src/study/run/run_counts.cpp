#include "study/run/run_counts.hpp"

namespace armwright {

void RunCounts::add(const EvaluationRecord& record) {
  const EvaluationStatus status = record.evaluation.status;
  const bool is_abandoned = status == EvaluationStatus::abandoned;
  ++evaluations;
  cases += record.calc_charge();
  clipped += record.clipped ? 1 : 0;
  abandoned += is_abandoned ? 1 : 0;
  failed += status == EvaluationStatus::ok || is_abandoned ? 0 : 1;
  feasible += is_feasible(record.evaluation) ? 1 : 0;
}

}  // namespace armwright
