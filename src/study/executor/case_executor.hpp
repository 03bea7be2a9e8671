// Simulates candidates on test cases. The unit of work is a pair of one candidate and one case, so
// one candidate on many cases uses all threads and lanes as well as many candidates on one case.
// Results depend neither on the executor, nor on the number of threads, nor on the chunks.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/stop_signal.hpp"
#include "problems/interface/problem.hpp"
#include "study/executor/thread_pool.hpp"

namespace armwright {

// Which optional parts an outcome shall have, if the problem provides them.
struct CaseExtras {
  bool residuals = false;
  bool jacobian = false;
};

// A batch is the product of some candidates and the cases of one block. Its pairs are numbered in
// tiles: each tile has as many candidates as the engine has lanes, and is numbered case by case.
// Consecutive pairs therefore share a case, so lanes read one target table together, and all cases
// of a candidate lie within one tile.
class CaseBatch {
 public:
  struct Pair {
    std::size_t candidate;
    std::size_t case_index;  // into block().numbers
  };
  // Receives the outcomes of the pairs first, first + 1, ... of `batch`. It is called from any
  // thread, also from several at once, and exactly once for each simulated pair.
  using Receive = std::function<void(const CaseBatch& batch, std::size_t first,
                                     std::vector<CaseOutcome> outcomes)>;

  // Refers to the problem, the candidates and the block, which must outlive the batch.
  CaseBatch(const Problem& problem, std::span<const std::span<const double>> candidates,
            const CaseBlock& block, CaseExtras extras, Receive receive);

  const Problem& problem() const { return problem_; }
  std::span<const std::span<const double>> candidates() const { return candidates_; }
  const CaseBlock& block() const { return block_; }
  CaseExtras extras() const { return extras_; }
  // Returns how many pairs one call of Problem::simulate() should get.
  BatchSize chunk_size() const { return chunk_size_; }
  std::size_t size() const { return candidates_.size() * block_.numbers.size(); }  // pairs
  Pair operator[](std::size_t number) const;

  // Returns the jobs of the pairs first, ..., first + count - 1. They refer to this batch.
  std::vector<CaseJob> make_jobs(std::size_t first, std::size_t count) const;
  // Hands outcomes to the receiver. Throws whatever the receiver throws.
  void deliver(std::size_t first, std::vector<CaseOutcome> outcomes) const {
    receive_(*this, first, std::move(outcomes));
  }

 private:
  const Problem& problem_;
  std::span<const std::span<const double>> candidates_;
  const CaseBlock& block_;
  CaseExtras extras_;
  BatchSize chunk_size_;
  Receive receive_;
};

// An executor simulates batches, on threads of this process or elsewhere as well.
class CaseExecutor {
 public:
  virtual ~CaseExecutor() = default;

  // Simulates all pairs and delivers their outcomes to the batch as soon as they are known. Blocks
  // until no outcome is left to deliver. A stop takes effect between chunks; the outcomes of the
  // remaining pairs are never delivered. Rethrows what the problem or the receiver throws.
  virtual void run(const CaseBatch& batch, StopSignal& stop) = 0;

  // Receives the outcomes of one candidate in the order of the block's cases; it may move from
  // them. It is called once per finished candidate, from the thread that finished the last case.
  using OnOutcomes = std::function<void(std::size_t candidate, std::span<CaseOutcome> outcomes)>;
  // Simulates every candidate on every case of the block. Candidates that a stop leaves unfinished
  // are not reported. Rethrows what the problem or `on_outcomes` throws.
  void simulate(const Problem& problem, std::span<const std::span<const double>> candidates,
                const CaseBlock& block, CaseExtras extras, StopSignal& stop,
                const OnOutcomes& on_outcomes);

  // Receives the evaluation of one candidate; it is called like OnOutcomes.
  using OnDone = std::function<void(std::size_t candidate, Evaluation evaluation)>;
  // As simulate(), and aggregates the outcomes of each candidate to an evaluation. Evaluations have
  // residuals only if `extras` asks for them.
  void evaluate(const Problem& problem, std::span<const std::span<const double>> candidates,
                const CaseBlock& block, CaseExtras extras, StopSignal& stop, const OnDone& on_done);
};

// A ThreadExecutor simulates batches on threads of this process.
class ThreadExecutor final : public CaseExecutor {
 public:
  // Starts the threads; `threads` includes the caller of run(), see ThreadPool.
  explicit ThreadExecutor(std::size_t threads) : pool_(threads) {}
  void run(const CaseBatch& batch, StopSignal& stop) override;
  ThreadPool& pool() { return pool_; }

 private:
  ThreadPool pool_;
};

}  // namespace armwright
