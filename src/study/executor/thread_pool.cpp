#include "study/executor/thread_pool.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace armwright {

ThreadPool::ThreadPool(std::size_t threads) {
  if (threads == 0) {
    throw std::invalid_argument("a thread pool of 0 threads; it needs at least 1, the caller");
  }
  try {
    while (workers_.size() + 1 < threads) {
      workers_.emplace_back([this] { work_loop(); });
    }
  } catch (const std::system_error&) {
    // The system grants no more threads; size() returns how many there are.
  } catch (...) {
    stop_workers();
    throw;
  }
  // A child that is forked while a thread starts may inherit a lock that the thread holds, for
  // example the lock of a sanitizer's memory. Nobody opens that lock in the child.
  std::unique_lock lock(mutex_);
  workers_done_.wait(lock, [this] { return started_workers_ == workers_.size(); });
}

ThreadPool::~ThreadPool() {
  stop_workers();
}

void ThreadPool::stop_workers() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  batch_began_.notify_all();
  for (std::thread& worker : workers_) {
    worker.join();
  }
}

void ThreadPool::run(std::size_t jobs, const std::function<void(std::size_t)>& job) {
  if (workers_.empty() || jobs <= 1) {
    for (std::size_t i = 0; i < jobs; ++i) {
      job(i);
    }
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    assert(job_ == nullptr && "ThreadPool::run is not reentrant");
    job_ = &job;
    ++batch_;
    failed_job_ = kNone;
    next_job_ = 0;
    end_job_ = jobs;
  }
  if (jobs - 1 < workers_.size()) {
    for (std::size_t i = 0; i + 1 < jobs; ++i) {
      batch_began_.notify_one();
    }
  } else {
    batch_began_.notify_all();
  }
  take_jobs(job);
  std::unique_lock lock(mutex_);
  job_ = nullptr;  // a worker that wakes up after this goes back to sleep
  workers_done_.wait(lock, [this] { return active_workers_ == 0; });
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
}

void ThreadPool::work_loop() {
  std::uint64_t last_batch = 0;
  std::unique_lock lock(mutex_);
  ++started_workers_;
  workers_done_.notify_one();
  while (true) {
    batch_began_.wait(lock, [&] { return stopping_ || (job_ != nullptr && batch_ != last_batch); });
    if (stopping_) {
      return;
    }
    last_batch = batch_;
    const auto& job = *job_;
    ++active_workers_;
    lock.unlock();
    take_jobs(job);
    lock.lock();
    if (--active_workers_ == 0) {
      workers_done_.notify_one();
    }
  }
}

void ThreadPool::take_jobs(const std::function<void(std::size_t)>& job) {
  while (true) {
    const std::size_t i = next_job_.fetch_add(1);
    // Jobs are taken in order, so every job below one that fails has been taken; it lies below
    // end_job_ and is run.
    if (i >= end_job_.load()) {
      return;
    }
    try {
      job(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (i < failed_job_) {
        failed_job_ = i;
        failure_ = std::current_exception();
        end_job_ = i;
      }
    }
  }
}

}  // namespace armwright
