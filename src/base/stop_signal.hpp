// A request that a run ends early, so that it can be resumed. Signal handlers and threads set it;
// code that hands out work polls it.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

namespace armwright {

enum class StopReason { none, interrupted, terminated, time_limit };

class StopSignal {
 public:
  using Clock = std::chrono::steady_clock;  // monotonic: setting the wall clock has no effect

  // Requests the stop. Safe in a signal handler. The first reason counts, but every other reason
  // replaces a time limit, which lets work in progress end (check_work_stop()).
  void request(StopReason reason) {
    StopReason before = StopReason::none;
    if (!reason_.compare_exchange_strong(before, reason) && before == StopReason::time_limit) {
      reason_.compare_exchange_strong(before, reason);
    }
  }
  // Sets the time of a stop. Call it before the run starts.
  void set_deadline(Clock::time_point deadline) { deadline_ = deadline; }
  // Sets a function that requested() calls first, from any thread. A host program that has no
  // signal handlers of armwright checks for interruptions there, and then calls request(). Call
  // this before the run starts.
  void set_lookout(std::function<void()> lookout) { lookout_ = std::move(lookout); }

  StopReason reason() const { return reason_; }
  bool requested() {
    if (lookout_) {
      lookout_();
    }
    if (deadline_ && Clock::now() >= *deadline_) {
      request(StopReason::time_limit);
    }
    return reason_ != StopReason::none;
  }

 private:
  std::atomic<StopReason> reason_ = StopReason::none;
  static_assert(std::atomic<StopReason>::is_always_lock_free);
  std::optional<Clock::time_point> deadline_;
  std::function<void()> lookout_;
};

// Thrown by work that a StopSignal ended and that cannot return the part done.
struct WorkStopped {};

}  // namespace armwright
