// What the children of this process have in common between fork() and what they are for.
#pragma once

#include <signal.h>
#include <sys/types.h>

namespace armwright {

// Around a fork(): until the child has handlers of its own, no signal may run this process's in it.
class AllSignalsBlocked {
 public:
  AllSignalsBlocked();
  ~AllSignalsBlocked();
  AllSignalsBlocked(const AllSignalsBlocked&) = delete;
  AllSignalsBlocked& operator=(const AllSignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

// In the child. All three are safe there, whatever threads the parent had.

// No handlers, nothing ignored, nothing blocked.
void reset_signals();
// Ctrl-C is the parent's to answer, and killing the group takes what the child starts as well.
void lead_own_group();
// Is killed when the thread that forked it ends, however that happens; ends here if it already has.
void die_with(pid_t parent);

}  // namespace armwright
