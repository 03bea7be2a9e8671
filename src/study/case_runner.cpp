#include "study/case_runner.hpp"

#include <atomic>
#include <utility>
#include <vector>

namespace armwright {

void CaseRunner::run(std::span<const std::span<const double>> candidates, const CaseBlock& block,
                     const OnDone& on_done) {
  const std::size_t cases = block.numbers.size();
  std::vector<CaseOutcome> outcomes(candidates.size() * cases);
  std::vector<std::atomic<std::size_t>> missing(candidates.size());
  for (std::atomic<std::size_t>& cases_left : missing) {
    cases_left = cases;
  }
  const auto simulate_case = [&](std::size_t job) {
    if (stop_.requested()) {
      return;
    }
    const std::size_t c = job / cases;
    const CaseJob one{candidates[c], &block, block.numbers[job % cases]};
    outcomes[job] = std::move(problem_.simulate({&one, 1}).front());
    if (--missing[c] == 0) {
      on_done(c, problem_.aggregate(candidates[c], std::span(outcomes).subspan(c * cases, cases)));
    }
  };
  pool_.run(outcomes.size(), simulate_case);
}

}  // namespace armwright
