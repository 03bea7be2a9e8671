// Shares batches out over the ranks of a job: threads of this process and, by messages, workers
// elsewhere (worker.hpp). Workers may come late, answer late, die, or be of no use: what they owe
// goes to others after a time, whoever is first counts, and there are always the threads here. The
// results do not depend on any of it, as every pair is simulated to the same bits everywhere.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "process/process_watch.hpp"
#include "study/executor/case_executor.hpp"
#include "study/executor/chunk_planner.hpp"
#include "study/executor/message_transport.hpp"
#include "study/executor/rank_messages.hpp"

namespace armwright {

struct CoordinatorSettings {
  std::size_t threads = 1;  // of this process, those that call run() included
  std::string cpu = {};     // this machine's; empty: workers may have what they like
  // A chunk is late when it takes longer than this and several times what is expected of it.
  double patience_s = 1;
};

class Coordinator final : public CaseExecutor {
 public:
  // What there is to say of workers, from a thread of its own, one at a time.
  using Notify = std::function<void(const std::string& message)>;

  // `problems` are those that workers have as well, in the same order, and `identity` says what
  // they are (WorkerIntroduction). Pairs of others are simulated here.
  Coordinator(Links& links, std::vector<const Problem*> problems, std::string identity,
              CoordinatorSettings settings, Notify notify);
  // Workers are left as they are: see end_workers().
  ~Coordinator() override;
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  // From any number of threads at once, each of which works along.
  void run(const CaseBatch& batch, StopSignal& stop) override;
  // No cases of the problem will be needed soon.
  void forget(const Problem& problem);
  // Whether a worker has not been heard of at all yet.
  bool expects_workers() const;
  // Threads of all ranks, if all have as many as this one.
  std::size_t estimate_threads() const { return links_.size() * settings_.threads; }

 private:
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;
  // Problem, role, with derivatives or without.
  using CostKey = std::tuple<const Problem*, CaseRole, bool>;

  struct Batch;
  struct Piece {
    std::shared_ptr<Batch> batch;
    std::size_t first = 0;
    std::size_t count = 0;
    bool delivered = false;
  };
  using PiecePointer = std::shared_ptr<Piece>;
  struct Batch {
    const CaseBatch* cases = nullptr;  // until `closed`
    StopSignal* stop = nullptr;
    std::optional<std::uint64_t> problem;  // that workers know it by
    PairCost* cost = nullptr;
    std::size_t next = 0;            // the first pair that nobody has taken yet
    std::deque<PiecePointer> again;  // taken by workers that are late
    std::size_t left = 0;            // pairs whose outcomes are missing
    std::size_t active = 0;          // threads that work on it or hand outcomes over
    bool closed = false;             // nothing more is taken or handed over
    std::exception_ptr failure;

    bool is_over() const { return active == 0 && (closed || left == 0); }
    void fail(const std::exception_ptr& reason) {
      failure = failure ? failure : reason;
      closed = true;
    }
  };
  struct Sent {
    PiecePointer piece;
    std::size_t worker = 0;
    Clock::time_point at;
    double at_awake_s = 0;
    double ahead_s = 0;     // of work that the worker had before it, as far as known
    bool was_idle = false;  // nothing was ahead
  };
  enum class State { unknown, ready, late, useless };
  struct Worker {
    State state = State::unknown;
    WorkerIntroduction introduction;
    std::size_t chunks = 0;  // under way
    Clock::time_point free_at;
    WorkerLatency latency;
    Clock::time_point heard_at;  // with outcomes
    double patience = 1;         // doubled whenever it was late and answers after all
  };

  // All with the lock held, which those that take it give back for a while.
  std::size_t count_untaken(const Batch& batch) const;
  double calc_left_here_s() const;
  PiecePointer take_piece(const std::shared_ptr<Batch>& batch, std::size_t count);
  PiecePointer take_here(const std::shared_ptr<Batch>& batch);
  void work_on(Lock& lock, const PiecePointer& piece);
  void deliver(Lock& lock, const PiecePointer& piece, std::vector<CaseOutcome> outcomes);
  TeamSize calc_team() const;

  void help();         // a thread's life
  void communicate();  // the life of the thread that alone uses the links
  void assign();
  void send_chunk(std::size_t rank, const PiecePointer& piece);
  void take_messages(Lock& lock);
  void take_message(Lock& lock, const Links::Message& message);
  void welcome(std::size_t rank, WorkerIntroduction introduction);
  void take_outcomes(Lock& lock, std::size_t rank, PacketReader& packet);
  void give_up(std::size_t rank, const std::string& reason);
  void reassign(std::size_t rank);
  void look_for_late();
  std::chrono::microseconds calc_pause() const;
  std::string name_worker(std::size_t rank) const;

  Links& links_;
  const std::vector<const Problem*> problems_;
  const std::string identity_;
  const CoordinatorSettings settings_;
  const Notify notify_;

  mutable std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::condition_variable wake_communication_;
  bool stopping_ = false;
  bool has_news_ = false;                    // for the thread that communicates
  std::list<Clock::time_point> busy_until_;  // threads, as far as costs are known
  std::list<std::shared_ptr<Batch>> batches_;
  std::map<CostKey, PairCost> costs_;
  std::vector<Worker> workers_;  // by rank; the first is this process
  std::map<std::uint64_t, Sent> sent_;
  std::uint64_t next_chunk_ = 0;
  std::vector<std::pair<std::size_t, std::string>> outgoing_;
  std::vector<std::string> notices_;
  WakingTime awake_;
  double last_alive_s_ = 0;
  double last_look_s_ = 0;  // for who is late

  std::vector<std::thread> helpers_;
  std::thread communication_;
};

// Tells all workers that there is no more work, and waits until each has said bye: true. False if
// one has not after `patience_s`: then MPI cannot be left in order. When no Coordinator is there
// any more.
bool end_workers(Links& links, double patience_s);

}  // namespace armwright
