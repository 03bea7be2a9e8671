// Simulates candidates on test cases. A candidate is a decision vector that lies within the bounds.
// The unit of work is a pair of one candidate and one case, so one candidate on many cases uses all
// threads and lanes as well as many candidates on one case. A chunk is a sequence of consecutive
// pairs that one thread or worker gets at once. Results depend neither on the executor, nor on the
// number of threads, nor on the chunks.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/stop_signal.hpp"
#include "problems/interface/problem.hpp"
#include "study/executor/thread_pool.hpp"

namespace armwright {

// Selects the optional parts of an outcome. A problem that cannot provide a part leaves it empty.
struct CaseExtras {
  bool residuals = false;
  bool jacobian = false;
};

// A batch holds every pair of its candidates and the cases of one block. Pairs are numbered tile by
// tile. A tile has as many candidates as the engine has lanes (the last tile may have fewer), with
// all their cases. Within a tile the numbers go case by case. For example, three candidates A, B, C
// on the cases 0 and 1 with two lanes:
//
//   number  0   1   2   3   4   5
//   pair    A0  B0  A1  B1  C0  C1
//
// Consecutive pairs therefore share a case, so lanes that are side by side read one target table.
// All pairs of a candidate lie within one tile. The const functions are thread-safe.
class CaseBatch {
 public:
  struct Pair {
    std::size_t candidate;   // index into candidates()
    std::size_t case_index;  // index into block().numbers
  };
  // Receives the outcomes of the pairs first, first + 1, ... of `batch`. Several threads may call
  // it at once. Every simulated pair is received exactly once.
  using Receive = std::function<void(const CaseBatch& batch, std::size_t first,
                                     std::vector<CaseOutcome> outcomes)>;

  // Keeps references to the problem, the candidates and the block. The caller owns them and keeps
  // them alive as long as the batch exists.
  CaseBatch(const Problem& problem, std::span<const std::span<const double>> candidates,
            const CaseBlock& block, CaseExtras extras, Receive receive);

  const Problem& problem() const { return problem_; }
  std::span<const std::span<const double>> candidates() const { return candidates_; }
  const CaseBlock& block() const { return block_; }
  CaseExtras extras() const { return extras_; }
  // Returns how many pairs a chunk should have: the pairs of one call of Problem::simulate(). With
  // a Jacobian that is one pair.
  BatchSize chunk_size() const { return chunk_size_; }
  std::size_t size() const { return candidates_.size() * block_.numbers.size(); }  // pairs
  // Returns the pair with this number, which must be less than size().
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

// Simulates jobs. Returns nothing if `stop` has ended the simulation: a user's problem waits no
// longer for its program. Throws whatever the problem throws.
std::optional<std::vector<CaseOutcome>> simulate_until(StopSignal& stop, const Problem& problem,
                                                       std::span<const CaseJob> jobs);

// An executor simulates batches on threads of this process, or also in other processes. Its
// functions must not be called from a callback. Only a Coordinator may be used by several threads
// at once.
class CaseExecutor {
 public:
  virtual ~CaseExecutor() = default;

  // Simulates all pairs. Delivers the outcomes to the batch as soon as their chunk is simulated.
  // Blocks until the last delivery has returned. After a stop no further chunk begins, and pairs
  // without an outcome are never delivered. Rethrows exceptions of the problem and of the receiver.
  virtual void run(const CaseBatch& batch, StopSignal& stop) = 0;

  // Receives the outcomes of one candidate in the order of the block's cases, and may move from
  // them. It is called once per finished candidate, by the thread that delivers the candidate's
  // last outcome. Threads may therefore call it at once for different candidates.
  using OnOutcomes = std::function<void(std::size_t candidate, std::span<CaseOutcome> outcomes)>;
  // Simulates every candidate on every case of the block, and blocks as run() does. Never calls
  // `on_outcomes` for a candidate that a stop leaves unfinished. Rethrows exceptions of the problem
  // and of `on_outcomes`.
  void simulate(const Problem& problem, std::span<const std::span<const double>> candidates,
                const CaseBlock& block, CaseExtras extras, StopSignal& stop,
                const OnOutcomes& on_outcomes);

  // Receives the evaluation of one candidate. It is called once per finished candidate, and threads
  // may call it at once for different candidates.
  using OnDone = std::function<void(std::size_t candidate, Evaluation evaluation)>;
  // Simulates like simulate(), and makes one evaluation of the outcomes of each finished candidate.
  // Evaluations have residuals only if `extras` asks for them. Rethrows exceptions of the problem
  // and of `on_done`.
  void evaluate(const Problem& problem, std::span<const std::span<const double>> candidates,
                const CaseBlock& block, CaseExtras extras, StopSignal& stop, const OnDone& on_done);
};

// A ThreadExecutor simulates batches on threads of this process.
class ThreadExecutor final : public CaseExecutor {
 public:
  // Starts the threads. `threads` (at least 1) includes the thread that calls run(). ThreadPool
  // says which errors it throws.
  explicit ThreadExecutor(std::size_t threads) : pool_(threads) {}
  void run(const CaseBatch& batch, StopSignal& stop) override;
  ThreadPool& pool() { return pool_; }

 private:
  ThreadPool pool_;
};

}  // namespace armwright
