#include "study/executor/chunk_planner.hpp"

#include <algorithm>
#include <cmath>

namespace armwright {
namespace {

// A thread's work in one chunk. Its messages cost 0.1 ms on both sides together, a hundredth of it.
constexpr double kChunk_s = 0.01;
// A chunk takes 10 us of the coordinator's thread for messages. With very many workers, chunks of
// at least this many seconds per worker use at most a quarter of that thread's time.
constexpr double kChunkEach_s = 4e-5;
constexpr double kLatest = 0.3;  // weight of the latest measurement in the mean

std::size_t round_up(std::size_t pairs, std::size_t granularity) {
  return (pairs + granularity - 1) / granularity * granularity;
}

// Returns one thread's share of the pairs that are left, rounded up to whole loads of lanes.
std::size_t calc_share(BatchSize size, std::size_t left, TeamSize team) {
  const std::size_t share = (left + 2 * team.all() - 1) / (2 * team.all());
  return std::max(size.granularity, round_up(share, size.granularity));
}

// Returns the pairs that take about `chunk_s` seconds, in whole loads of lanes, at least one.
std::size_t calc_timely(BatchSize size, double chunk_s, double cost_s) {
  const double pairs = chunk_s / std::max(cost_s, 1e-9);
  const auto granularity = static_cast<double>(size.granularity);
  return static_cast<std::size_t>(std::max(1.0, std::floor(pairs / granularity))) *
         size.granularity;
}

}  // namespace

void PairCost::add(double seconds, std::size_t pairs) {
  if (pairs == 0) {
    return;
  }
  const double latest = seconds / static_cast<double>(pairs);
  seconds_ = seconds_ ? (1 - kLatest) * *seconds_ + kLatest * latest : latest;
}

void WorkerLatency::add(double seconds) {
  constexpr double kMostRise = 4;
  seconds_ += kLatest * (std::min(seconds, kMostRise * seconds_) - seconds_);
}

double WorkerLatency::get_s(double unused_s) const {
  // A worker that is too slow for batches of b seconds is tried again every few seconds. That costs
  // less than b.
  constexpr double kForgetting_s = 1;
  return seconds_ / (1 + unused_s / kForgetting_s);
}

std::size_t plan_local_chunk(BatchSize size, std::size_t left, TeamSize team,
                             std::optional<double> cost_s) {
  if (team.all() <= 1) {
    return std::min(left, size.largest);  // one thread alone shares with no other
  }
  if (!cost_s) {
    return std::min(left, size.granularity);
  }
  const std::size_t most =
      std::min(std::max(size.largest, size.granularity), calc_timely(size, kChunk_s, *cost_s));
  return std::min(left, std::min(calc_share(size, left, team), most));
}

std::size_t plan_remote_chunk(BatchSize size, std::size_t left, TeamSize team,
                              std::optional<double> cost_s, double left_here_s,
                              const WorkerLoad& worker) {
  if (worker.chunks >= kChunksAhead) {
    return 0;
  }
  if (!cost_s) {
    const std::size_t least = size.granularity * worker.threads;
    return worker.chunks == 0 && left > size.granularity * team.here ? std::min(left, least) : 0;
  }
  const double chunk_s = std::max(kChunk_s, kChunkEach_s * static_cast<double>(team.workers));
  const std::size_t most =
      std::min(calc_share(size, left, team), calc_timely(size, chunk_s, *cost_s));
  const std::size_t pairs = std::min(left, most * worker.threads);
  const std::size_t a_thread = (pairs + worker.threads - 1) / worker.threads;
  const double done_s = worker.busy_s + worker.latency_s + static_cast<double>(a_thread) * *cost_s;
  return done_s <= left_here_s ? pairs : 0;
}

}  // namespace armwright
