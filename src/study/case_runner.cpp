#include "study/case_runner.hpp"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace armwright {
namespace {

struct Pair {
  std::size_t candidate;
  std::size_t case_index;
};

// The order in which pairs are shared out: tiles of as many candidates as an engine has lanes, in
// each tile case by case. So lanes side by side follow the same targets, which are then read once
// for all, and a candidate is done when its tile is.
class PairOrder {
 public:
  PairOrder(std::size_t candidates, std::size_t cases, std::size_t lanes)
      : candidates_(candidates), cases_(cases), lanes_(lanes) {}

  Pair operator[](std::size_t number) const {
    const std::size_t first = number / (lanes_ * cases_) * lanes_;
    const std::size_t width = std::min(lanes_, candidates_ - first);
    const std::size_t in_tile = number - first * cases_;
    return {first + in_tile % width, in_tile / width};
  }

 private:
  std::size_t candidates_, cases_, lanes_;
};

}  // namespace

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
                           const CaseBlock& block, Extras extras, const OnOutcomes& on_outcomes) {
  const std::size_t cases = block.numbers.size();
  const std::size_t pairs = candidates.size() * cases;
  // Derivatives take far longer than the simulation that lanes make fast.
  const BatchSize size = extras.jacobian ? BatchSize{} : problem_.batch_size(block.role);
  const std::size_t chunk = calc_chunk(size, pairs, pool_.size());
  const PairOrder order(candidates.size(), cases, size.granularity);
  std::vector<CaseOutcome> outcomes(pairs);  // candidate by candidate
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
    for (std::size_t i = first; i < end; ++i) {
      const Pair pair = order[i];
      jobs.push_back({.x = candidates[pair.candidate],
                      .block = &block,
                      .number = block.numbers[pair.case_index],
                      .residuals = extras.residuals,
                      .jacobian = extras.jacobian});
    }
    std::vector<CaseOutcome> simulated = problem_.simulate(jobs);
    for (std::size_t i = first; i < end; ++i) {
      const Pair pair = order[i];
      outcomes[pair.candidate * cases + pair.case_index] = std::move(simulated[i - first]);
      if (--missing[pair.candidate] == 0) {
        on_outcomes(pair.candidate, std::span(outcomes).subspan(pair.candidate * cases, cases));
      }
    }
  };
  pool_.run((pairs + chunk - 1) / chunk, simulate_chunk);
}

}  // namespace armwright
