// Makes traces by hand for the tests of the export formats.
#pragma once

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <optional>
#include <vector>

#include "report/formats/run_traces.hpp"

namespace armwright {

// Returns a run with one variable, x = 0.5, and one case per evaluation. Each evaluation has one of
// the objectives; an empty one stands for a failed evaluation. `change` may then change them.
inline RunTrace make_trace(
    std::initializer_list<std::optional<double>> objectives,
    const std::function<void(std::vector<TracedEvaluation>&)>& change = [](auto&) {}) {
  std::vector<TracedEvaluation> evaluations;
  RunTrace trace;
  trace.run = {"run", "some problem", "some label", "ga", 3};
  trace.names = {{"width"}, {"error"}, {}};
  for (const auto& objective : objectives) {
    TracedEvaluation evaluation;
    evaluation.number = evaluations.size() + 1;
    evaluation.simulated_cases = evaluation.number;
    evaluation.x = {0.5};
    evaluation.feasible = objective.has_value();
    evaluation.objective = objective;
    if (objective) {
      evaluation.objectives = {*objective};
    } else {
      evaluation.status = EvaluationStatus::failed;
    }
    evaluations.push_back(std::move(evaluation));
  }
  change(evaluations);
  trace.evaluations = TracedEvaluations([evaluations](const TracedEvaluations::Visitor& visitor) {
    std::ranges::for_each(evaluations, visitor);
  });
  return trace;
}

}  // namespace armwright
