// A worker is a rank that simulates the chunks that the coordinator (coordinator.hpp) sends to it,
// on its own threads, until it is told to end. It writes no files.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/stop_signal.hpp"
#include "process/process_watch.hpp"
#include "study/executor/case_packets.hpp"
#include "study/executor/message_transport.hpp"
#include "study/executor/rank_messages.hpp"

namespace armwright {

class Worker {
 public:
  // Starts the threads and introduces the worker to the coordinator. `problems` are in the
  // coordinator's order; an introduction with a failure needs none. Transport and problems must
  // outlive the worker. The coordinator sends a message at least every ten seconds; the worker
  // treats it as dead after `silence_s` without one.
  Worker(MessageTransport& transport, std::vector<const Problem*> problems,
         WorkerIntroduction introduction, double silence_s = 120);
  ~Worker();  // stops the simulations that have begun, and waits for those that cannot be stopped
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  enum class End {
    finalize,  // all ranks are there and end MPI in order
    leave,     // some worker is missing: exit without ending MPI
    abandoned  // the coordinator is dead
  };
  // Works until the coordinator ends the work, and returns how it ended. Throws PacketError for a
  // message that is not the coordinator's.
  End serve();

 private:
  struct Chunk;

  bool handle_message(const std::string& message, End& end);  // true: it was the last one
  void add_chunk(PacketReader& packet);
  void send_results();
  void run_thread();
  // Simulates the next jobs of a waiting chunk. Needs the lock and releases it for a while.
  void simulate_jobs(std::unique_lock<std::mutex>& lock, const std::shared_ptr<Chunk>& waiting);

  MessageTransport& transport_;
  const std::vector<const Problem*> problems_;
  const double longest_silence_s_;
  WakingTime silence_;
  StopSignal stop_;  // ends simulations whose results the coordinator no longer needs

  std::mutex mutex_;  // guards all members below
  std::condition_variable has_work_;
  std::condition_variable has_results_;
  bool stopping_ = false;
  std::deque<std::shared_ptr<Chunk>> waiting_;  // chunks with jobs that no thread has taken yet
  std::deque<std::shared_ptr<Chunk>> done_;
  std::size_t under_way_ = 0;  // chunks received and not yet answered
  std::vector<std::thread> threads_;
};

}  // namespace armwright
