// Plans how many pairs the coordinator of an MPI job gives out at a time, and to which of its
// threads or workers, from measured costs alone. None of these functions influences a result.
// They throw nothing.
//
// A chunk must be long enough for the time of its message to be negligible, and short enough for
// all threads to end a batch at the same time. A chunk is therefore a fixed share of the pairs that
// are left, within bounds of time: guided self-scheduling (Polychronopoulos and Kuck 1987).
#pragma once

#include <cstddef>
#include <optional>

#include "base/batch_size.hpp"

namespace armwright {

// The measured time of one pair: a moving mean, for one problem, one role, and with or without
// derivatives.
class PairCost {
 public:
  // Adds the measurement that one thread took `seconds` for `pairs` pairs. Ignores 0 pairs.
  void add(double seconds, std::size_t pairs);
  // Returns the seconds per pair, or nothing before the first measurement.
  std::optional<double> get_s() const { return seconds_; }

 private:
  std::optional<double> seconds_;
};

// The latency of a worker: the time from sending a chunk to an idle worker until its outcomes
// arrive, without the time of the simulations. It rises slowly and decays while it is not measured:
// a worker that was slow once gets no chunks of small batches, and is tried again after a while.
class WorkerLatency {
 public:
  void add(double seconds);
  // Returns the latency `unused_s` seconds after the last measurement.
  double get_s(double unused_s) const;

 private:
  double seconds_ = 0.001;
};

struct TeamSize {
  std::size_t here = 1;       // threads of the coordinator
  std::size_t elsewhere = 0;  // threads of the workers that are ready
  std::size_t workers = 0;    // that are ready
  std::size_t all() const { return here + elsewhere; }
};

// Returns the number of pairs for one thread of the coordinator. `left` counts the pairs that are
// not taken yet; `cost_s` is the time of one pair, if it is known.
std::size_t plan_local_chunk(BatchSize size, std::size_t left, TeamSize team,
                             std::optional<double> cost_s);

// Chunks that a worker may have at a time: it works on one and has the next one already, so it does
// not wait for messages.
inline constexpr std::size_t kChunksAhead = 2;

struct WorkerLoad {
  std::size_t threads = 1;
  std::size_t chunks = 0;  // under way to the worker
  double busy_s = 0;       // expected time until it has finished them
  double latency_s = 0;    // see WorkerLatency
};

// Returns the number of pairs for a worker. `left_here_s` is the time in which the coordinator's
// threads alone would finish all that is left. As long as the cost is not known, a worker gets the
// smallest chunk: `size.granularity` pairs per thread. The number is 0 in these cases:
// - The worker already has kChunksAhead chunks.
// - The cost is not known, and the worker has a chunk, or at most `size.granularity` pairs are left
//   per thread of the coordinator.
// - The cost is known, and the worker would finish the pairs later than `left_here_s`.
std::size_t plan_remote_chunk(BatchSize size, std::size_t left, TeamSize team,
                              std::optional<double> cost_s, double left_here_s,
                              const WorkerLoad& worker);

}  // namespace armwright
