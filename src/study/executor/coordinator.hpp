// Shares batches over the ranks of a job: the threads of this process and, by messages, workers in
// other processes (worker.hpp). Workers may start late, answer late, die, or be unusable. The pairs
// of a worker that does not answer in time go to others, the first outcomes to arrive count, and
// the threads of this process can always finish a batch alone. Results do not depend on any of
// this, because every pair is simulated to the same bits everywhere.
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
  std::size_t threads = 1;  // of this process, including those that call run()
  std::string cpu = {};     // of this machine; empty: any CPU of a worker is accepted silently
  // A chunk is late if it takes longer than this plus four times its expected time. Workers that
  // were late before get more time.
  double late_after_s = 1;
};

// A Coordinator is the executor of rank 0. Its functions are thread-safe.
class Coordinator final : public CaseExecutor {
 public:
  // Receives messages about workers for the user. It is called from one thread of the coordinator.
  using Notify = std::function<void(const std::string& message)>;

  // `problems` must be the workers' problems in the same order, and `identity` describes them
  // (WorkerIntroduction); batches of other problems are simulated in this process only. Transport
  // and problems must outlive the coordinator. Only the coordinator may use the transport while it
  // exists. Throws std::system_error if no thread can be started for communication.
  Coordinator(MessageTransport& transport, std::vector<const Problem*> problems,
              std::string identity, CoordinatorSettings settings, Notify notify);
  // Waits for simulations of this process. Workers keep running: see end_workers().
  ~Coordinator() override;
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  // May be called from several threads at once; each of them simulates as well.
  void run(const CaseBatch& batch, StopSignal& stop) override;
  // Frees what this process and the workers keep for the cases of the problem.
  void forget(const Problem& problem);
  // Returns whether some worker has not introduced itself yet.
  bool expects_workers() const;
  // Returns the number of threads of all ranks, assuming that each has as many as this one.
  std::size_t estimate_threads() const { return transport_.size() * settings_.threads; }

 private:
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;
  // Problem, role, whether with derivatives.
  using CostKey = std::tuple<const Problem*, CaseRole, bool>;

  struct Batch;
  // Consecutive pairs of a batch that one thread or one worker simulates.
  struct Piece {
    std::shared_ptr<Batch> batch;
    std::size_t first = 0;
    std::size_t count = 0;
    bool delivered = false;
  };
  using PiecePointer = std::shared_ptr<Piece>;
  struct Batch {
    const CaseBatch* cases = nullptr;  // valid until `closed`
    StopSignal* stop = nullptr;
    std::optional<std::uint64_t> problem;  // the workers' number for it, if they have it
    PairCost* cost = nullptr;
    std::size_t next = 0;            // the first pair that is in no piece yet
    std::deque<PiecePointer> again;  // pieces of late workers, to be simulated by others
    std::size_t left = 0;            // pairs whose outcomes are missing
    std::size_t active = 0;          // threads that simulate or deliver its pairs
    bool closed = false;             // no pair is taken or delivered any more
    std::exception_ptr failure;

    bool is_over() const { return active == 0 && (closed || left == 0); }
    void fail(const std::exception_ptr& reason) {
      failure = failure ? failure : reason;
      closed = true;
    }
  };
  // A piece under way to a worker: a chunk.
  struct SentPiece {
    PiecePointer piece;
    std::size_t worker = 0;
    Clock::time_point at;
    double at_awake_s = 0;
    double ahead_s = 0;     // expected time of the worker's chunks before this one
    bool was_idle = false;  // the worker had no chunk before this one
  };
  enum class WorkerState { unknown, ready, late, excluded };
  struct RemoteWorker {
    WorkerState state = WorkerState::unknown;
    WorkerIntroduction introduction;
    std::size_t chunks = 0;  // under way
    Clock::time_point free_at;
    WorkerLatency latency;
    Clock::time_point heard_at;  // when its last outcomes arrived
    double late_factor = 1;      // doubled whenever a late worker answers after all
  };

  // All functions below need the lock; those that take it as an argument release it for a while.
  std::size_t count_untaken(const Batch& batch) const;
  double calc_left_here_s() const;
  PiecePointer take_piece(const std::shared_ptr<Batch>& batch, std::size_t count);
  PiecePointer take_local_piece(const std::shared_ptr<Batch>& batch);
  void simulate_piece(Lock& lock, const PiecePointer& piece);
  void deliver(Lock& lock, const PiecePointer& piece, std::vector<CaseOutcome> outcomes);
  TeamSize calc_team() const;

  void run_helper();     // the body of a helper thread
  void run_transport();  // the body of the thread that alone uses the transport
  void assign();
  void send_chunk(std::size_t rank, const PiecePointer& piece);
  void receive_messages(Lock& lock);
  void handle_message(Lock& lock, const MessageTransport::Message& message);
  void admit_worker(std::size_t rank, WorkerIntroduction introduction);
  void handle_outcomes(Lock& lock, std::size_t rank, PacketReader& packet);
  void exclude_worker(std::size_t rank, const std::string& reason);
  void reassign(std::size_t rank);
  void check_late_workers();
  std::chrono::microseconds calc_pause() const;
  std::string name_worker(std::size_t rank) const;

  MessageTransport& transport_;
  const std::vector<const Problem*> problems_;
  const std::string identity_;
  const CoordinatorSettings settings_;
  const Notify notify_;

  mutable std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  std::condition_variable wake_communication_;
  bool stopping_ = false;
  bool has_news_ = false;                    // for the thread that uses the transport
  std::list<Clock::time_point> busy_until_;  // expected end of each busy thread's piece
  std::list<std::shared_ptr<Batch>> batches_;
  std::map<CostKey, PairCost> costs_;
  std::vector<RemoteWorker> workers_;  // by rank; rank 0 is this process
  std::map<std::uint64_t, SentPiece> sent_;
  std::uint64_t next_chunk_ = 0;
  std::vector<std::pair<std::size_t, std::string>> outgoing_;
  std::vector<std::string> notices_;
  WakingTime awake_;
  double last_alive_s_ = 0;
  double last_check_s_ = 0;  // of check_late_workers()

  std::vector<std::thread> helpers_;
  std::thread communication_;
};

// Tells all workers that there is no more work, and waits at most `timeout_s` for their answers.
// Returns false if a worker has not answered; MPI cannot be ended in order then. No Coordinator may
// use the transport at the same time.
bool end_workers(MessageTransport& transport, double timeout_s);

}  // namespace armwright
