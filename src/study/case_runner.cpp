#include "study/case_runner.hpp"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace armwright {

void CaseRunner::run(std::span<const std::span<const double>> candidates, const CaseBlock& block,
                     bool residuals, const OnDone& on_done, bool jacobian) {
  const std::size_t cases = block.numbers.size();
  const std::size_t pairs = candidates.size() * cases;
  // Derivatives take far longer than the simulation that lanes make fast.
  const BatchSize size = jacobian ? BatchSize{} : problem_.batch_size(block.role);
  const std::size_t chunk = calc_chunk(size, pairs, pool_.size());
  std::vector<CaseOutcome> outcomes(pairs);
  std::vector<std::atomic<std::size_t>> missing(candidates.size());
  for (std::atomic<std::size_t>& cases_left : missing) {
    cases_left = cases;
  }
  const auto simulate_chunk = [&](std::size_t number) {
    if (stop_.requested()) {
      return;
    }
    const std::size_t first = number * chunk;
    const std::size_t end = std::min(pairs, first + chunk);
    std::vector<CaseJob> jobs;
    jobs.reserve(end - first);
    for (std::size_t pair = first; pair < end; ++pair) {
      jobs.push_back({.x = candidates[pair / cases],
                      .block = &block,
                      .number = block.numbers[pair % cases],
                      .residuals = residuals,
                      .jacobian = jacobian});
    }
    std::ranges::move(problem_.simulate(jobs),
                      outcomes.begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t pair = first; pair < end;) {
      const std::size_t candidate = pair / cases;
      const std::size_t done = std::min(end, (candidate + 1) * cases) - pair;
      if (missing[candidate].fetch_sub(done) == done) {
        const auto its_outcomes = std::span(outcomes).subspan(candidate * cases, cases);
        Evaluation evaluation = problem_.aggregate(candidates[candidate], its_outcomes);
        if (!residuals) {
          evaluation.residuals.clear();  // of a problem that makes them unasked
        }
        on_done(candidate, std::move(evaluation));
      }
      pair += done;
    }
  };
  pool_.run((pairs + chunk - 1) / chunk, simulate_chunk);
}

}  // namespace armwright
