// Asks a run to come to a graceful, resumable end. Set from signal handlers and threads, polled
// wherever work is handed out.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>

namespace armwright {

enum class StopReason { none, interrupted, terminated, time_limit };

class StopSignal {
 public:
  using Clock = std::chrono::steady_clock;  // monotonic: a changed wall clock stops nothing

  // Safe in a signal handler. The first reason stays.
  void request(StopReason reason) {
    StopReason none = StopReason::none;
    reason_.compare_exchange_strong(none, reason);
  }
  void set_deadline(Clock::time_point deadline) { deadline_ = deadline; }  // before the run starts

  StopReason reason() const { return reason_; }
  bool requested() {
    if (deadline_ && Clock::now() >= *deadline_) {
      request(StopReason::time_limit);
    }
    return reason_ != StopReason::none;
  }

 private:
  std::atomic<StopReason> reason_ = StopReason::none;
  static_assert(std::atomic<StopReason>::is_always_lock_free);
  std::optional<Clock::time_point> deadline_;
};

}  // namespace armwright
