// How many pairs go out at a time, and to whom: from measured costs alone. Nothing of this changes
// a result.
//
// A chunk that takes c seconds a pair is as long as it must be for its message not to count, and as
// short as it must be for the batch to end everywhere at the same time: guided self-scheduling
// (Polychronopoulos and Kuck 1987), a share of what is left, within bounds of time.
#pragma once

#include <cstddef>
#include <optional>

#include "base/batch_size.hpp"

namespace armwright {

// Of one kind of pair: a problem, a role, with derivatives or without.
class PairCost {
 public:
  // A chunk of `pairs` took a thread so long.
  void learn(double seconds, std::size_t pairs);
  std::optional<double> get_s() const { return seconds_; }

 private:
  std::optional<double> seconds_;  // a pair, a moving mean
};

// From the sending of a chunk to a worker that has nothing else to do to its outcomes, beside the
// work itself. It rises slowly, and fades while it is not measured: a worker that was slow once,
// and so gets nothing of small batches, could not show otherwise that it is quick again.
class WorkerLatency {
 public:
  void learn(double seconds);
  // So long after it was measured.
  double get_s(double unused_s) const;

 private:
  double seconds_ = 0.001;
};

struct TeamSize {
  std::size_t here = 1;       // threads of the coordinator
  std::size_t elsewhere = 0;  // threads of the workers that are there
  std::size_t workers = 0;
  std::size_t all() const { return here + elsewhere; }
};

// Pairs for one thread of the coordinator; `left` are those that nobody has taken yet.
std::size_t plan_local_chunk(BatchSize size, std::size_t left, TeamSize team,
                             std::optional<double> cost_s);

// A worker has one chunk in work and the next one at hand, so that it need not wait for messages.
inline constexpr std::size_t kChunksAhead = 2;

// A worker as the coordinator sees it.
struct WorkerLoad {
  std::size_t threads = 1;
  std::size_t chunks = 0;  // under way
  double busy_s = 0;       // until it will have done them, as far as costs are known
  double latency_s = 0;    // from the sending of a chunk to its outcomes, beside the work itself
};

// Pairs for a worker, 0 if it is not worth while: it would have them done later than the threads
// here, which by themselves would have done all that is left in `left_here_s`. While nothing is
// known of the cost a worker gets as little as can be.
std::size_t plan_remote_chunk(BatchSize size, std::size_t left, TeamSize team,
                              std::optional<double> cost_s, double left_here_s,
                              const WorkerLoad& worker);

}  // namespace armwright
