#include "study/executor/case_executor.hpp"

#include <algorithm>

namespace armwright {

void ThreadExecutor::run(const CaseBatch& batch, StopSignal& stop) {
  const std::size_t pairs = batch.size();
  const std::size_t chunk = calc_chunk(batch.batch_size(), pairs, pool_.size());
  pool_.run((pairs + chunk - 1) / chunk, [&](std::size_t number) {
    if (!stop.requested()) {
      const std::size_t first = number * chunk;
      const std::size_t count = std::min(chunk, pairs - first);
      batch.take(first, batch.problem().simulate(batch.make_jobs(first, count)));
    }
  });
}

}  // namespace armwright
