// Fans evaluations out over threads, one simulated case at a time, so that one candidate on many
// cases uses all cores as well as many candidates on one. Results do not depend on the number of
// threads.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "problems/problem.hpp"
#include "study/stop.hpp"
#include "study/thread_pool.hpp"

namespace armwright {

class CaseRunner {
 public:
  CaseRunner(const Problem& problem, ThreadPool& pool, StopSignal& stop)
      : problem_(problem), pool_(pool), stop_(stop) {}

  // Called once for each finished candidate, from the thread that finished it, as soon as its last
  // case is done.
  using OnDone = std::function<void(std::size_t candidate, Evaluation evaluation)>;

  // Every candidate on every case of the block. Those that a stop leaves unfinished `on_done` never
  // hears of. Rethrows what `on_done` throws.
  void run(std::span<const std::span<const double>> candidates, const CaseBlock& block,
           const OnDone& on_done);

 private:
  const Problem& problem_;
  ThreadPool& pool_;
  StopSignal& stop_;
};

}  // namespace armwright
