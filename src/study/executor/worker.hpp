// A rank that simulates what the coordinator (coordinator.hpp) sends, on threads of its own, until
// it is told to end. It writes nothing anywhere.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "process/process_watch.hpp"
#include "study/executor/case_packets.hpp"
#include "study/executor/message_transport.hpp"
#include "study/executor/rank_messages.hpp"

namespace armwright {

class Worker {
 public:
  // `problems` in the coordinator's order. An introduction that says why this rank cannot work goes
  // without any. A coordinator says that it is alive every ten seconds; one that is silent for
  // longer than `silence_s` is no more.
  Worker(Links& links, std::vector<const Problem*> problems, WorkerIntroduction introduction,
         double silence_s = 120);
  ~Worker();  // waits for simulations that have begun
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // How the work has ended: all ranks leave in order; somebody is missing; the coordinator is no
  // more.
  enum class End { finalize, leave, abandoned };
  End serve();

 private:
  struct Chunk {
    std::uint64_t number = 0;
    const Problem* problem = nullptr;
    ReceivedJobs received;
    std::size_t jobs_at_once = 1;
    std::vector<CaseOutcome> outcomes;
    std::size_t next = 0;     // the first job that no thread has taken yet
    std::size_t missing = 0;  // jobs whose outcomes are missing
    double busy_s = 0;        // of all threads
    std::string failure;
  };

  bool take_message(const std::string& message, End& end);  // whether it was the last
  void take_chunk(PacketReader& packet);
  void send_results();
  void work();  // a thread's life
  void simulate_some(std::unique_lock<std::mutex>& lock, const std::shared_ptr<Chunk>& chunk);

  Links& links_;
  const std::vector<const Problem*> problems_;
  const double longest_silence_s_;
  WakingTime silence_;

  std::mutex mutex_;  // of all below
  std::condition_variable has_work_;
  std::condition_variable has_results_;
  bool stopping_ = false;
  std::deque<std::shared_ptr<Chunk>> waiting_;  // of which some jobs have not been begun
  std::deque<std::shared_ptr<Chunk>> done_;
  std::size_t under_way_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace armwright
