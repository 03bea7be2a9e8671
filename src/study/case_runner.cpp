#include "study/case_runner.hpp"

#include <algorithm>
#include <atomic>

namespace armwright {

std::vector<std::optional<Evaluation>> CaseRunner::run(std::span<const CandidateJob> candidates,
                                                       const OnDone& on_done) {
  std::vector<std::size_t> first_job(candidates.size() + 1);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    first_job[c + 1] = first_job[c] + candidates[c].block->numbers.size();
  }
  std::vector<CaseOutcome> outcomes(first_job.back());
  std::vector<std::atomic<std::size_t>> missing(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    missing[c] = first_job[c + 1] - first_job[c];
  }
  std::vector<std::optional<Evaluation>> evaluations(candidates.size());

  pool_.run(outcomes.size(), [&](std::size_t job) {
    if (stop_.requested()) {
      return;
    }
    const auto after = std::upper_bound(first_job.begin(), first_job.end(), job);
    const auto c = static_cast<std::size_t>(after - first_job.begin()) - 1;
    const CaseBlock& block = *candidates[c].block;
    const CaseJob one{candidates[c].x, &block, block.numbers[job - first_job[c]]};
    outcomes[job] = std::move(problem_.simulate({&one, 1}).front());
    if (--missing[c] > 0) {
      return;
    }
    evaluations[c] = problem_.aggregate(
        candidates[c].x,
        std::span(outcomes).subspan(first_job[c], first_job[c + 1] - first_job[c]));
    on_done(c, *evaluations[c]);
  });
  return evaluations;
}

}  // namespace armwright
