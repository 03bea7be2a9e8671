#include "base/batch_size.hpp"

#include <algorithm>

namespace armwright {

std::size_t calc_chunk(BatchSize size, std::size_t jobs, std::size_t threads) {
  // With this many chunks per thread, threads wait at most an eighth of the time for the last
  // chunk.
  constexpr std::size_t kChunksPerThread = 8;
  if (threads <= 1) {
    return size.largest;  // a single thread shares no work
  }
  const auto divide_up = [](std::size_t a, std::size_t b) { return (a + b - 1) / b; };
  const std::size_t share = divide_up(jobs, kChunksPerThread * threads);
  const std::size_t whole = divide_up(share, size.granularity) * size.granularity;
  return std::clamp(whole, size.granularity, std::max(size.granularity, size.largest));
}

}  // namespace armwright
