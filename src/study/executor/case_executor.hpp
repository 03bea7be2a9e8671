// Who simulates a batch: threads of this process, or others' as well. Results do not depend on it.
#pragma once

#include <cstddef>

#include "base/stop_signal.hpp"
#include "study/executor/case_batch.hpp"
#include "study/executor/thread_pool.hpp"

namespace armwright {

class CaseExecutor {
 public:
  virtual ~CaseExecutor() = default;
  // Simulates all pairs and hands their outcomes to the batch as they are done; returns when
  // nothing is left to be handed over. A stop counts between chunks; pairs that it leaves out the
  // batch never hears of. Rethrows what the batch or the problem throws.
  virtual void run(const CaseBatch& batch, StopSignal& stop) = 0;
};

class ThreadExecutor final : public CaseExecutor {
 public:
  // As ThreadPool.
  explicit ThreadExecutor(std::size_t threads) : pool_(threads) {}
  void run(const CaseBatch& batch, StopSignal& stop) override;
  ThreadPool& pool() { return pool_; }

 private:
  ThreadPool pool_;
};

}  // namespace armwright
