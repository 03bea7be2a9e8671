// Functions that the children of this process need after fork().
#pragma once

#include <signal.h>
#include <sys/types.h>

namespace armwright {

// Blocks all signals in its scope. Use it around fork(), so that no handler of this process runs in
// the child.
class AllSignalsBlocked {
 public:
  AllSignalsBlocked();
  ~AllSignalsBlocked();
  AllSignalsBlocked(const AllSignalsBlocked&) = delete;
  AllSignalsBlocked& operator=(const AllSignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

// The three functions below run in the child. They are safe there, even if the parent has threads.

// Removes all signal handlers, and unblocks and unignores all signals.
void reset_signals();
// Makes the child the leader of a process group. Ctrl-C then reaches only the parent, and killing
// the group also kills what the child has started.
void lead_own_group();
// Makes the kernel kill the child when the thread that forked it ends. Ends the child now if that
// thread has already ended.
void die_with(pid_t parent);

}  // namespace armwright
