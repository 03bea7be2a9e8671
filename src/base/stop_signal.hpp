// Asks a run to come to a graceful, resumable end. Set from signal handlers and threads, polled
// wherever work is handed out.
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
  using Clock = std::chrono::steady_clock;  // monotonic: a changed wall clock stops nothing

  // Safe in a signal handler. The first reason stays.
  void request(StopReason reason) {
    StopReason none = StopReason::none;
    reason_.compare_exchange_strong(none, reason);
  }
  void set_deadline(Clock::time_point deadline) { deadline_ = deadline; }  // before the run starts
  // Called whenever somebody asks whether to stop, from any thread: for hosts that learn of
  // interruptions otherwise than by signal handlers of ours, and then request() one. Before the run
  // starts.
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

}  // namespace armwright
