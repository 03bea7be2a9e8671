// Fans evaluations out over threads, one simulated case at a time, so that one candidate on many
// cases uses all cores as well as many candidates on one. Results do not depend on the number of
// threads.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "problems/problem.hpp"
#include "study/stop.hpp"
#include "study/thread_pool.hpp"

namespace armwright {

struct CandidateJob {
  std::span<const double> x;
  const CaseBlock* block = nullptr;
};

class CaseRunner {
 public:
  CaseRunner(const Problem& problem, ThreadPool& pool, StopSignal& stop)
      : problem_(problem), pool_(pool), stop_(stop) {}

  // Called once for each finished candidate, from the thread that finished it, as soon as its last
  // case is done.
  using OnDone = std::function<void(std::size_t candidate, const Evaluation& evaluation)>;

  // One evaluation a candidate, in order; nothing for those that a stop left unfinished. Rethrows
  // what `on_done` throws.
  std::vector<std::optional<Evaluation>> run(std::span<const CandidateJob> candidates,
                                             const OnDone& on_done);

 private:
  const Problem& problem_;
  ThreadPool& pool_;
  StopSignal& stop_;
};

}  // namespace armwright
