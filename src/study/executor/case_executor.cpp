#include "study/executor/case_executor.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "process/stop_scope.hpp"

namespace armwright {

CaseBatch::CaseBatch(const Problem& problem, std::span<const std::span<const double>> candidates,
                     const CaseBlock& block, CaseExtras extras, Receive receive)
    : problem_(problem),
      candidates_(candidates),
      block_(block),
      extras_(extras),
      // Derivatives take far longer than the simulation that lanes make fast.
      chunk_size_(extras.jacobian ? BatchSize{} : problem.batch_size(block.role)),
      receive_(std::move(receive)) {}

CaseBatch::Pair CaseBatch::operator[](std::size_t number) const {
  const std::size_t lanes = chunk_size_.granularity;
  const std::size_t cases = block_.numbers.size();
  const std::size_t first = number / (lanes * cases) * lanes;
  const std::size_t width = std::min(lanes, candidates_.size() - first);
  const std::size_t in_tile = number - first * cases;
  return {first + in_tile % width, in_tile / width};
}

std::vector<CaseJob> CaseBatch::make_jobs(std::size_t first, std::size_t count) const {
  std::vector<CaseJob> jobs;
  jobs.reserve(count);
  for (std::size_t number = first; number < first + count; ++number) {
    const Pair pair = (*this)[number];
    jobs.push_back({.x = candidates_[pair.candidate],
                    .block = &block_,
                    .number = block_.numbers[pair.case_index],
                    .residuals = extras_.residuals,
                    .jacobian = extras_.jacobian});
  }
  return jobs;
}

void CaseExecutor::simulate(const Problem& problem,
                            std::span<const std::span<const double>> candidates,
                            const CaseBlock& block, CaseExtras extras, StopSignal& stop,
                            const OnOutcomes& on_outcomes) {
  const std::size_t cases = block.numbers.size();
  std::vector<CaseOutcome> all(candidates.size() * cases);  // candidate by candidate
  std::vector<std::atomic<std::size_t>> missing(candidates.size());
  for (std::atomic<std::size_t>& cases_left : missing) {
    cases_left = cases;
  }
  const auto receive = [&](const CaseBatch& batch, std::size_t first,
                           std::vector<CaseOutcome> outcomes) {
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const CaseBatch::Pair pair = batch[first + i];
      all[pair.candidate * cases + pair.case_index] = std::move(outcomes[i]);
      if (--missing[pair.candidate] == 0) {
        on_outcomes(pair.candidate, std::span(all).subspan(pair.candidate * cases, cases));
      }
    }
  };
  run(CaseBatch(problem, candidates, block, extras, receive), stop);
}

void CaseExecutor::evaluate(const Problem& problem,
                            std::span<const std::span<const double>> candidates,
                            const CaseBlock& block, CaseExtras extras, StopSignal& stop,
                            const OnDone& on_done) {
  simulate(problem, candidates, block, extras, stop,
           [&](std::size_t candidate, std::span<CaseOutcome> outcomes) {
             Evaluation evaluation = problem.aggregate(candidates[candidate], outcomes);
             if (!extras.residuals) {
               evaluation.residuals.clear();  // some problems always make them
             }
             on_done(candidate, std::move(evaluation));
           });
}

std::optional<std::vector<CaseOutcome>> simulate_until(StopSignal& stop, const Problem& problem,
                                                       std::span<const CaseJob> jobs) {
  const StopScope scope(&stop);
  try {
    return problem.simulate(jobs);
  } catch (const WorkStopped&) {
    return std::nullopt;
  }
}

void ThreadExecutor::run(const CaseBatch& batch, StopSignal& stop) {
  const std::size_t pairs = batch.size();
  const std::size_t chunk = calc_chunk(batch.chunk_size(), pairs, pool_.size());
  pool_.run((pairs + chunk - 1) / chunk, [&](std::size_t number) {
    if (stop.requested()) {
      return;
    }
    const std::size_t first = number * chunk;
    const auto jobs = batch.make_jobs(first, std::min(chunk, pairs - first));
    if (auto outcomes = simulate_until(stop, batch.problem(), jobs)) {
      batch.deliver(first, *std::move(outcomes));
    }
  });
}

}  // namespace armwright
