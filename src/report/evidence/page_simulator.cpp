#include "report/evidence/page_simulator.hpp"

#include <algorithm>
#include <utility>

namespace armwright {

void PageSimulator::report(std::uint64_t more_cases) {
  done_ += more_cases;
  expected_ = std::max(expected_, done_);
  Progress progress;
  progress.phase = CaseRole::test;
  progress.done = done_;
  progress.total = expected_;
  observer_.on_progress(progress);
}

void PageSimulator::run(std::size_t jobs, std::size_t cases_per_job, std::uint64_t cases,
                        const std::function<void(std::size_t)>& job) {
  // Between two checks of the stop signal, every thread has several jobs, so that no thread waits
  // long for the others.
  constexpr std::size_t kRoundsAtOnce = 4;
  const std::size_t at_once = kRoundsAtOnce * executor_.pool().size();
  for (std::size_t first = 0; first < jobs; first += at_once) {
    if (stop_.requested()) {
      throw WorkStopped{};
    }
    const std::size_t count = std::min(at_once, jobs - first);
    executor_.pool().run(count, [&](std::size_t i) {
      if (!stop_.requested()) {
        job(first + i);
      }
    });
    const std::uint64_t before = first * cases_per_job;
    report(std::min<std::uint64_t>(cases - before, count * cases_per_job));
  }
  if (stop_.requested()) {
    throw WorkStopped{};
  }
}

void PageSimulator::run(std::size_t jobs, const std::function<void(std::size_t)>& job) {
  run(jobs, 1, jobs, job);
}

std::vector<TrackingResult> PageSimulator::evaluate(const TrackingProblem& problem,
                                                    const ArmDesign& design, const TestSet& set,
                                                    std::uint64_t first, std::uint64_t count) {
  problem.check_design(design);
  std::vector<TrackingResult> results(count);
  const std::size_t chunk =
      calc_chunk(problem.batch_size(CaseRole::test), count, executor_.pool().size());
  run((results.size() + chunk - 1) / chunk, chunk, count, [&](std::size_t number) {
    const std::size_t begin = number * chunk;
    const std::size_t size = std::min(chunk, results.size() - begin);
    std::ranges::move(problem.track(design, set, first + begin, size, {}),
                      results.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  return results;
}

Evaluation PageSimulator::evaluate(const Problem& problem, std::span<const double> x,
                                   const CaseBlock& block) {
  Evaluation evaluation;
  executor_.evaluate(problem, std::span(&x, 1), block, {}, stop_,
                     [&](std::size_t, Evaluation done) { evaluation = std::move(done); });
  if (stop_.requested()) {
    throw WorkStopped{};
  }
  report(block.numbers.size());
  return evaluation;
}

}  // namespace armwright
