// A thread pool is a fixed number of threads that work through the jobs of one batch at a time.
// Idle threads sleep.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

namespace armwright {

class ThreadPool {
 public:
  // Starts `threads` - 1 threads: the caller of run() is the remaining one. If the system does not
  // grant that many, the pool works with fewer; size() returns how many. Throws
  // std::invalid_argument for 0.
  explicit ThreadPool(std::size_t threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  // Returns the number of threads, including the caller of run().
  std::size_t size() const { return workers_.size() + 1; }

  // Calls job(0) to job(jobs - 1) once each and returns when all have ended. Jobs begin in this
  // order, on whichever thread is free. If jobs throw, no job with a higher number is begun any
  // more, and the exception of the lowest one is rethrown: the same one for any number of threads.
  // Must not be called from a job or from two threads at once.
  void run(std::size_t jobs, const std::function<void(std::size_t)>& job);

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  void work_loop();
  void take_jobs(const std::function<void(std::size_t)>& job);
  void stop_workers();

  std::mutex mutex_;
  std::condition_variable batch_began_;
  std::condition_variable workers_done_;
  const std::function<void(std::size_t)>* job_ = nullptr;  // null between batches
  std::uint64_t batch_ = 0;
  std::size_t started_workers_ = 0;
  std::size_t active_workers_ = 0;
  bool stopping_ = false;
  std::size_t failed_job_ = kNone;  // the lowest number of a job that threw
  std::exception_ptr failure_;

  std::atomic<std::size_t> next_job_ = 0;
  // No job from this number on is begun: the number of jobs, or the lowest job that threw.
  std::atomic<std::size_t> end_job_ = 0;
  std::vector<std::thread> workers_;
};

}  // namespace armwright
