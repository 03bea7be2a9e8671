// A fixed number of threads that share out the jobs of one batch at a time. Idle threads sleep.
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
  // `threads` counts the caller of run(); 1 creates none. std::invalid_argument for 0. If the
  // system does not grant that many, the pool works with fewer; size() says how many.
  explicit ThreadPool(std::size_t threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t size() const { return workers_.size() + 1; }

  // Calls job(0) to job(jobs - 1), each once, begun in this order and spread over the threads as
  // these become free; returns when all have ended. If jobs throw, those with higher numbers that
  // have not begun are left out, and the exception of the lowest one is rethrown: the same one for
  // any number of threads. Not to be called from a job or from two threads at once.
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
  std::size_t active_workers_ = 0;
  bool stopping_ = false;
  std::size_t failed_job_ = kNone;  // the lowest
  std::exception_ptr failure_;

  std::atomic<std::size_t> next_job_ = 0;
  std::atomic<std::size_t> end_job_ =
      0;  // no job from here on is begun: their number, or the lowest that failed
  std::vector<std::thread> workers_;
};

}  // namespace armwright
