// Tells work that waits for another process, deep inside a simulation, of the stop that ends it.
#pragma once

#include "base/stop_signal.hpp"

namespace armwright {

// The time in which the calling thread works for somebody whose stop is `stop`. Scopes nest, and
// the innermost counts. `stop` must live as long as the scope; null: no stop ends this work.
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
// again and again would never get further.
void check_work_stop();

}  // namespace armwright
