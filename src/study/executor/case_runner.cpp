#include "study/executor/case_runner.hpp"

#include <atomic>
#include <utility>
#include <vector>

namespace armwright {

void CaseRunner::run(std::span<const std::span<const double>> candidates, const CaseBlock& block,
                     bool residuals, const OnDone& on_done, bool jacobian) {
  run_cases(candidates, block, {residuals, jacobian},
            [&](std::size_t candidate, std::span<CaseOutcome> outcomes) {
              Evaluation evaluation = problem_.aggregate(candidates[candidate], outcomes);
              if (!residuals) {
                evaluation.residuals.clear();  // of a problem that makes them unasked
              }
              on_done(candidate, std::move(evaluation));
            });
}

void CaseRunner::run_cases(std::span<const std::span<const double>> candidates,
                           const CaseBlock& block, CaseExtras extras,
                           const OnOutcomes& on_outcomes) {
  const std::size_t cases = block.numbers.size();
  std::vector<CaseOutcome> all(candidates.size() * cases);  // candidate by candidate
  std::vector<std::atomic<std::size_t>> missing(candidates.size());
  for (std::atomic<std::size_t>& cases_left : missing) {
    cases_left = cases;
  }
  const auto take = [&](const CaseBatch& batch, std::size_t first,
                        std::vector<CaseOutcome> outcomes) {
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const CaseBatch::Pair pair = batch[first + i];
      all[pair.candidate * cases + pair.case_index] = std::move(outcomes[i]);
      if (--missing[pair.candidate] == 0) {
        on_outcomes(pair.candidate, std::span(all).subspan(pair.candidate * cases, cases));
      }
    }
  };
  executor_.run(CaseBatch(problem_, candidates, block, extras, take), stop_);
}

}  // namespace armwright
