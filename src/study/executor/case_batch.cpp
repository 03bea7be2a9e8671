#include "study/executor/case_batch.hpp"

#include <algorithm>
#include <utility>

namespace armwright {

CaseBatch::CaseBatch(const Problem& problem, std::span<const std::span<const double>> candidates,
                     const CaseBlock& block, CaseExtras extras, Take take)
    : problem_(problem),
      candidates_(candidates),
      block_(block),
      extras_(extras),
      // Derivatives take far longer than the simulation that lanes make fast.
      batch_size_(extras.jacobian ? BatchSize{} : problem.batch_size(block.role)),
      take_(std::move(take)) {}

CaseBatch::Pair CaseBatch::operator[](std::size_t number) const {
  const std::size_t lanes = batch_size_.granularity;
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

}  // namespace armwright
