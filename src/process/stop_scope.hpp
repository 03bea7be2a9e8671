// Tells work that waits for another process, deep inside a simulation, of the stop that ends it.
#pragma once

#include "base/stop_signal.hpp"

namespace armwright {

// The time in which `stop` ends the work of the calling thread. Scopes nest, and the innermost
// counts. `stop` must live as long as the scope; null: no stop ends this work.
class StopScope {
 public:
  explicit StopScope(StopSignal* stop);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  StopSignal* before_;
};

// Returns the stop of the calling thread's work; null outside of scopes.
StopSignal* get_work_stop();

// Throws WorkStopped if the user or the system has stopped the calling thread's work. A time limit
// does not end work in progress: where one case takes longer than the limit, a run that is continued
// again and again would never get further. The workers of `compare` are an exception: at its time
// limit they get SIGTERM, which is a stop by the system, so a case in progress is lost there.
void check_work_stop();

// Call this before the death of a child is recorded as its own fault. A job system sends the signal
// that stops this process to its children as well, in any order. So this waits a moment for the
// stop, and throws as check_work_stop() does.
void await_work_stop();

}  // namespace armwright
