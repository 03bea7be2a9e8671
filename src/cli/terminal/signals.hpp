// Ctrl-C (SIGINT), SIGTERM and SIGHUP as requests for a graceful, resumable end.
#pragma once

#include "base/stop_signal.hpp"

namespace armwright {

// From now on these signals set `stop`, which must outlive the process's other threads; a second
// one ends the process at once, with exit code 130 for SIGINT and 75 for the others. What the
// parent had set to be ignored stays ignored (nohup, background jobs).
void catch_signals(StopSignal& stop);

}  // namespace armwright
